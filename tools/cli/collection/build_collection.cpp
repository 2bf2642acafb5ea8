#include "collection/build_collection.hpp"

#include <fmt/core.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "collection/digest.hpp"
#include "collection/objects.hpp"
#include "collection/overview.hpp"
#include "collection/part.hpp"
#include "collection/row.hpp"
#include "exit_codes.hpp"
#include "scan/preview.hpp"
#include "tactree/support/high_descriptor.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnchanged = "unchanged";

void create_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    support::refuse(folder.string(), "cannot be created: " + error.message(),
                    "choose another folder with --output");
  }
}

class CollectionBuild {
 public:
  CollectionBuild(const CollectionRequest& request, const builder::BuildOptions& build,
                  const BoardRequest& board, builder::ProgressStyle progress)
      : request_(request), build_(build), board_(board), progress_(progress) {}

  /// Returns the row of the object, with the result "unchanged" if it was up to date. No failure of
  /// an object stops the others.
  [[nodiscard]] ObjectRow run(const CollectionObject& object) const {
    try {
      return build_if_changed(object);
    } catch (const std::runtime_error& error) {
      return row_of_failure(object, "", error.what());
    }
  }

 private:
  [[nodiscard]] ObjectRow build_if_changed(const CollectionObject& object) const {
    const ObjectFiles files(request_.output, object);
    const std::string digest = digest_of_object(request_.options_digest, object.input);
    if (std::optional<ObjectRow> row = read_row(files); row && is_current(*row, digest, files)) {
      (*row)["result"] = kUnchanged;
      return std::move(*row);
    }
    create_folder(files.row.parent_path());
    // Otherwise, a row of an earlier run would be taken for the one of this child.
    fs::remove(files.row);
    const std::string ending = build_in_child(object, digest, files);
    if (std::optional<ObjectRow> row = read_row(files)) {
      return std::move(*row);
    }
    ObjectRow row = row_of_failure(object, digest,
                                   fmt::format("{}: the build was ended by {} (give it more memory "
                                               "or choose a larger --spacing; else report this "
                                               "with the file)",
                                               object.input.string(), ending));
    write_failure(row, files);
    return row;
  }

  [[nodiscard]] static bool is_current(const ObjectRow& row, const std::string& digest,
                                       const ObjectFiles& files) {
    std::error_code ignored;
    return text_of(row, "digest") == digest && text_of(row, "result") != kResultFailed &&
           fs::exists(files.preview, ignored) &&
           text_of(row, "blob_digest") == digest_of_file(files.blob);
  }

  static void write_failure(const ObjectRow& row, const ObjectFiles& files) {
    std::error_code ignored;
    fs::remove(files.blob, ignored);  // they would be those of an earlier scan or of other options
    fs::remove(files.preview, ignored);
    support::write_file(files.row, support::json_text(row));
  }

  /// A crash, or a lack of memory, then ends only this object. Returns what ended the child.
  [[nodiscard]] std::string build_in_child(const CollectionObject& object,
                                           const std::string& digest,
                                           const ObjectFiles& files) const {
    std::fflush(stdout);
    const pid_t parent = ::getpid();
    const pid_t child = ::fork();
    if (child < 0) {
      support::fail_with_errno("fork");
    }
    if (child == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (::getppid() == parent) {
        ::_exit(build_and_write(object, digest, files));
      }
      ::_exit(kExitFailed);
    }
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFSIGNALED(status) ? fmt::format("signal {}", WTERMSIG(status))
                               : fmt::format("exit code {}", WEXITSTATUS(status));
  }

  /// Runs in the child. If the row cannot be written either, the parent finds the cause when it
  /// writes one.
  [[nodiscard]] int build_and_write(const CollectionObject& object, const std::string& digest,
                                    const ObjectFiles& files) const {
    try {
      const std::string error = build_object(object, digest, files);
      if (!error.empty()) {
        write_failure(row_of_failure(object, digest, error), files);
      }
      return kExitOk;
    } catch (const std::exception&) {
      return kExitFailed;
    }
  }

  /// Returns the error; empty if the blob, its picture and its row were written.
  [[nodiscard]] std::string build_object(const CollectionObject& object, const std::string& digest,
                                         const ObjectFiles& files) const {
    try {
      const std::unique_ptr<builder::Progress> progress = builder::make_progress(progress_, stderr);
      const std::array inputs = {object.input};
      const builder::BuildResult result = build_for_board(inputs, build_, board_, *progress);
      progress->end();
      support::write_file(files.blob, std::span<const std::byte>(result.blob.bytes));
      write_preview(files.preview, view_of(result), result.report.openings, result.doubtful,
                    build_.materials, result.colours);
      const ObjectRow row =
          row_of_build(object, digest, digest_of_file(files.blob), result.report, build_);
      support::write_file(files.row, support::json_text(row));
      return "";
    } catch (const std::bad_alloc&) {
      return object.input.string() + ": out of memory (choose a larger --spacing, or --crop)";
    } catch (const std::exception& error) {
      return error.what();
    }
  }

  const CollectionRequest& request_;
  const builder::BuildOptions& build_;
  const BoardRequest& board_;
  builder::ProgressStyle progress_;
};

void print_object(const ObjectRow& row, std::size_t number, std::size_t count) {
  const std::string result = text_of(row, "result");
  fmt::print("{:<9} {}/{} {}", result, number, count, text_of(row, "name"));
  if (result == kResultOk || result == kResultAmbiguous) {
    const std::size_t warnings = row.at("warnings").size();
    fmt::print(": {} points, {} bytes, {:.2f} s, {} warning{}",
               row.at("points").get<std::uint64_t>(), row.at("bytes").get<std::uint64_t>(),
               row.at("seconds").get<double>(), warnings, warnings == 1 ? "" : "s");
  }
  fmt::print("\n");
  std::fflush(stdout);
}

std::vector<ObjectRow> build_part(const CollectionBuild& build, const CollectionPart& part,
                                  const Collection& collection) {
  std::vector<const CollectionObject*> objects;
  for (std::size_t i = 0; i < collection.objects.size(); ++i) {
    if (part.has(i)) {
      objects.push_back(&collection.objects[i]);
    }
  }
  fmt::print("part      {}/{}{}: {} of {} objects\n", part.number, part.count,
             part.origin.empty() ? "" : " (" + part.origin + ")", objects.size(),
             collection.objects.size());
  std::vector<ObjectRow> rows;
  for (const CollectionObject* const object : objects) {
    rows.push_back(build.run(*object));
    print_object(rows.back(), rows.size(), objects.size());
  }
  return rows;
}

/// Prints the sums and the failures. Returns false if there are any.
bool report_rows(const std::vector<ObjectRow>& rows, const fs::path& json) {
  std::map<std::string, std::size_t> results;
  ObjectRow failures = ObjectRow::array();
  for (const ObjectRow& row : rows) {
    const std::string result = text_of(row, "result");
    ++results[result];
    if (result == kResultFailed || result == kResultMissing) {
      failures.push_back(
          {{"name", text_of(row, "name")}, {"result", result}, {"error", text_of(row, "error")}});
    }
  }
  fmt::print("objects   {}", rows.size());
  for (const auto& [result, count] : results) {
    fmt::print(", {} {}", count, result);
  }
  fmt::print("\n");
  if (!json.empty()) {
    const ObjectRow summary{{"objects", rows.size()}, {"results", results}, {"failures", failures}};
    support::write_file(json, support::json_text(summary));
  }
  if (failures.empty()) {
    return true;
  }
  fmt::print(stderr, "tactree: error: {} of {} objects failed:\n", failures.size(), rows.size());
  for (const ObjectRow& failure : failures) {
    fmt::print(stderr, "  {}\n", text_of(failure, "error"));
  }
  return false;
}

}  // namespace

bool build_collection(const CollectionRequest& request, const builder::BuildOptions& build,
                      const BoardRequest& board, builder::ProgressStyle progress) {
  const CollectionPart part = request.collect ? CollectionPart{} : choose_part(request.part);
  support::check_outputs({request.json}, {request.collection});
  const Collection collection = read_collection(request.collection, request.output);
  std::vector<std::filesystem::path> scans;
  for (const CollectionObject& object : collection.objects) {
    scans.push_back(object.input);
  }
  support::check_outputs({request.json}, scans);
  create_folder(request.output);
  if (collection.left_out > 0) {
    fmt::print("left out  {} file{} without the extension of a scan\n", collection.left_out,
               collection.left_out == 1 ? "" : "s");
  }
  std::vector<ObjectRow> rows;
  if (!request.collect) {
    rows = build_part(CollectionBuild(request, build, board, progress), part, collection);
  }
  if (part.count == 1) {
    const std::vector<ObjectRow> all = read_rows(request.output, collection.objects);
    write_overview(request.output, all);
    fmt::print("wrote     {}\n", (request.output / "manifest.csv").string());
    fmt::print("wrote     {}\n", (request.output / "index.html").string());
    rows = request.collect ? all : rows;
  }
  return report_rows(rows, request.json);
}

}  // namespace tactree::cli
