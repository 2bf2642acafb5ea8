// The builder's side of the mesh import process: finds and starts the program, and validates its
// output, which is untrusted.

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "child_output.hpp"
#include "mesh_import/wire.hpp"
#include "number.hpp"
#include "readers.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "tactree-import-mesh";
constexpr const char* kVariable = "TACTREE_IMPORT_MESH";
// Maximum length of a message, because some messages of the library quote the file at length.
constexpr std::size_t kQuoted = 600;
constexpr const char* kSaveAsPly = "open it in Blender or MeshLab and save it as PLY";

bool is_program(const fs::path& path) { return ::access(path.c_str(), X_OK) == 0; }

/// Searches the environment variable, the folder of this program, the installation and the build
/// tree.
fs::path find_program(const std::string& file) {
  if (const char* named = std::getenv(kVariable); named != nullptr && *named != '\0') {
    if (is_program(named)) return named;
    throw ReadError(file, "", fmt::format("{} names \"{}\", which cannot be run", kVariable, named),
                    fmt::format("set it to the path of {}, or unset it", kProgram));
  }
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& candidate :
       {folder / kProgram, folder / ".." / "libexec" / "tactree" / kProgram,
        fs::path(TACTREE_IMPORT_MESH_BUILT)}) {
    if (!candidate.empty() && is_program(candidate)) return candidate;
  }
  throw ReadError(
      file, "", fmt::format("the program {}, which reads this format, is missing", kProgram),
      fmt::format("install it, or set the environment variable {} to its path", kVariable));
}

class MeshImport {
 public:
  MeshImport(const fs::path& file, const Recognition& recognition, const ReadOptions& options)
      : path_(file.string()),
        name_(options.label.empty() ? path_ : options.label),
        recognition_(recognition),
        child_(arguments(file, recognition, options), options.child_seconds),
        builder_(name_, options, "face") {}

  Scan read() {
    const WireHeader header = read_header();
    const std::string text = read_text(header.text_bytes);
    check_status(header, text);
    if (!text.empty()) builder_.warn(text);
    if (header.unit_m > 0.0 && std::isfinite(header.unit_m)) builder_.set_unit(header.unit_m);
    read_points(header);
    read_triangles(header);
    std::array<char, kWireEnd.size()> end{};
    receive(end.data(), end.size());
    if (end != kWireEnd) fail_invalid();
    return builder_.finish(recognition_.name);
  }

 private:
  static std::vector<std::string> arguments(const fs::path& file, const Recognition& recognition,
                                            const ReadOptions& options) {
    const double seconds = std::clamp(std::ceil(options.child_seconds), 1.0, 1e9);
    return {find_program(file.string()).string(), file.string(), recognition.hint,
            fmt::format("{}", options.child_memory_bytes), fmt::format("{:.0f}", seconds)};
  }

  WireHeader read_header() {
    WireHeader header;
    receive(&header, sizeof header);
    if (header.magic != kWireMagic || header.text_bytes > kMaxWireText) fail_invalid();
    return header;
  }

  std::string read_text(std::uint32_t bytes) {
    std::string text(bytes, '\0');
    receive(text.data(), text.size());
    for (char& c : text) {
      if (static_cast<unsigned char>(c) < ' ') c = ' ';
    }
    text = trim(text);
    for (std::size_t at = text.find(path_); at != std::string::npos;
         at = text.find(path_, at + name_.size())) {
      text.replace(at, path_.size(), name_);
    }
    return text.size() <= kQuoted ? text : text.substr(0, kQuoted) + " ...";
  }

  void check_status(const WireHeader& header, const std::string& text) const {
    switch (static_cast<WireStatus>(header.status)) {
      case WireStatus::kOk:
        return;
      case WireStatus::kRefused:
        throw ReadError(name_, "",
                        fmt::format("this {} cannot be read: {}", recognition_.name, text),
                        kSaveAsPly);
      case WireStatus::kOutOfMemory:
        throw ReadError(name_, "",
                        fmt::format("reading this {} exceeds the memory limit", recognition_.name),
                        "the file is damaged or too large; reduce it first");
    }
    fail_invalid();
  }

  void read_points(const WireHeader& header) {
    const bool normals = (header.flags & kHasNormals) != 0;
    const bool colours = (header.flags & kHasColours) != 0;
    if (normals) builder_.use_normals();
    if (colours) builder_.use_colours(ColourRange::kByte);
    builder_.limit_face_indices(header.points);
    PointRow row{};
    for (std::uint64_t i = 0; i < header.points; ++i) {
      receive(row.data(), 3 * sizeof(double));
      if (normals) {
        std::array<float, 3> normal{};
        receive(normal.data(), sizeof normal);
        for (std::size_t k = 0; k < 3; ++k) row[kNx + k] = static_cast<double>(normal[k]);
      }
      if (colours) {
        std::array<std::uint8_t, 3> colour{};
        receive(colour.data(), sizeof colour);
        for (std::size_t k = 0; k < 3; ++k) row[kRed + k] = colour[k];
      }
      builder_.add_point(row);
    }
  }

  void read_triangles(const WireHeader& header) {
    for (std::uint64_t i = 0; i < header.triangles; ++i) {
      std::array<std::uint32_t, 3> triangle{};
      receive(triangle.data(), sizeof triangle);
      const std::array<std::int64_t, 3> corners = {triangle[0], triangle[1], triangle[2]};
      builder_.add_face(corners, i + 1);
    }
  }

  void receive(void* into, std::size_t size) {
    if (child_.read(into, size)) return;
    throw ReadError(name_, "",
                    fmt::format("the mesh importer {} while reading this {}",
                                child_.wait_and_describe_end(), recognition_.name),
                    fmt::format("the file is probably damaged; {}", kSaveAsPly));
  }

  [[noreturn]] void fail_invalid() const {
    throw ReadError(name_, "", "the output of the mesh importer is not valid",
                    fmt::format("check that {} has the version of this program", kProgram));
  }

  std::string path_;
  std::string name_;
  const Recognition& recognition_;
  ChildOutput child_;
  ScanBuilder builder_;
};

}  // namespace

Scan import_mesh(const fs::path& file, const Recognition& recognition, const ReadOptions& options) {
  try {
    return MeshImport(file, recognition, options).read();
  } catch (const std::system_error& error) {
    throw ReadError(file.string(), "",
                    fmt::format("the mesh importer cannot be started: {}", error.what()),
                    "check the limits on processes and memory");
  }
}

}  // namespace tactree::builder
