#include "collection/objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "tactree/builder/read_scan.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;

/// Without "." and "..", and without a trailing slash. Links are kept.
fs::path plain_path(const fs::path& path) {
  const fs::path plain = fs::absolute(path).lexically_normal();
  return plain.has_filename() ? plain : plain.parent_path();
}

std::string object_name(const fs::path& input, const fs::path& folder) {
  const fs::path full = plain_path(input);
  const fs::path inside = full.lexically_relative(folder);
  return inside.empty() || *inside.begin() == ".." ? full.relative_path().string()
                                                   : inside.string();
}

std::vector<fs::path> listed_scans(const fs::path& list) {
  std::ifstream in(list);
  std::vector<fs::path> scans;
  for (std::string line; std::getline(in, line);) {
    line.erase(line.find_last_not_of(" \t\r") + 1);
    line.erase(0, line.find_first_not_of(" \t"));
    if (!line.empty() && line[0] != '#') {
      scans.push_back(list.parent_path() / line);
    }
  }
  if (in.bad() || !in.eof()) {
    support::refuse(list.string(), "cannot be read", "check the path and its permissions");
  }
  return scans;
}

bool has_scan_extension(const fs::path& file, const std::vector<std::string>& extensions) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return !extension.empty() &&
         std::find(extensions.begin(), extensions.end(), extension.substr(1)) != extensions.end();
}

std::vector<fs::path> scans_below(const fs::path& folder, const fs::path& output,
                                  std::size_t& left_out) {
  std::error_code ignored;
  if (fs::equivalent(folder, output, ignored)) {
    support::refuse(output.string(), "is the folder of the scans",
                    "choose another folder with --output");
  }
  const std::vector<std::string> extensions = builder::scan_formats();
  std::error_code error;
  std::vector<fs::path> scans;
  fs::recursive_directory_iterator entry(folder, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    if (entry->is_directory(ignored)) {
      if (fs::equivalent(entry->path(), output, ignored)) {
        entry.disable_recursion_pending();
      }
    } else if (has_scan_extension(entry->path(), extensions)) {
      scans.push_back(entry->path());
    } else {
      ++left_out;
    }
  }
  if (error) {
    support::refuse(folder.string(), "cannot be listed: " + error.message(),
                    "check the permissions of its folders");
  }
  return scans;
}

/// Sorts by name and drops scans that are listed twice.
void make_unique(std::vector<CollectionObject>& objects, const std::string& place) {
  std::sort(objects.begin(), objects.end(),
            [](const CollectionObject& a, const CollectionObject& b) { return a.name < b.name; });
  const auto is_repeated = [&place](const CollectionObject& a, const CollectionObject& b) {
    if (a.name == b.name && plain_path(a.input) != plain_path(b.input)) {
      support::refuse(place,
                      fmt::format("{} and {} would have the same name in the output, {}",
                                  a.input.string(), b.input.string(), a.name),
                      "put them into two collections");
    }
    return a.name == b.name;
  };
  objects.erase(std::unique(objects.begin(), objects.end(), is_repeated), objects.end());
}

}  // namespace

Collection read_collection(const fs::path& place, const fs::path& output) {
  Collection collection;
  std::error_code ignored;
  const bool is_folder = fs::is_directory(place, ignored);
  const fs::path folder = plain_path(is_folder ? place : fs::absolute(place).parent_path());
  const std::vector<fs::path> scans =
      is_folder ? scans_below(place, output, collection.left_out) : listed_scans(place);
  for (const fs::path& scan : scans) {
    collection.objects.push_back({object_name(scan, folder), scan});
  }
  make_unique(collection.objects, place.string());
  if (collection.objects.empty()) {
    support::refuse(place.string(), is_folder ? "has no scans" : "names no scans",
                    is_folder ? "name files with other extensions in a list, one path per line"
                              : "write one path per line");
  }
  return collection;
}

}  // namespace tactree::cli
