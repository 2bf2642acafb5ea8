#include "tactree/builder/read_scan.hpp"

#include <new>

#include "input_file.hpp"
#include "readers.hpp"
#include "recognise.hpp"

namespace tactree::builder {
namespace {

Scan read_recognised(InputFile& file, const std::filesystem::path& path,
                     const Recognition& recognition, const ReadOptions& options) {
  switch (recognition.kind) {
    case FileKind::kPly:
      return read_ply(file, options);
    case FileKind::kPcd:
      return read_pcd(file, options);
    case FileKind::kPtx:
      return read_ptx(file, options);
    case FileKind::kE57:
      return read_e57(file, path, options);
    case FileKind::kLas:
      return read_las(file, path, options);
    case FileKind::kObj:
      return read_obj(file, options);
    case FileKind::kOff:
      return read_off(file, options);
    case FileKind::kOffBinary:
      return read_off_binary(file, options);
    case FileKind::kStlAscii:
      return read_stl_ascii(file, options);
    case FileKind::kStlBinary:
      return read_stl_binary(file, options);
    case FileKind::kImportedMesh:
      return import_mesh(path, recognition, options);
    case FileKind::kText:
      return read_text(file, options);
    case FileKind::kUnsupported:
      break;
  }
  throw ReadError(file.name(), "", "this is " + recognition.name, recognition.remedy);
}

/// If columns are given, text of a format without a reader is read as a table.
Recognition recognise_for(InputFile& file, const ReadOptions& options) {
  const std::string_view head = file.peek(kHeadBytes);
  Recognition found = options.format.empty() ? recognise(head, file.size())
                                             : recognise_as(options.format, head, file.size());
  if (options.columns.empty() || found.kind == FileKind::kText) return found;
  if (found.kind == FileKind::kUnsupported && is_text(head)) {
    return {FileKind::kText, "text", "", ""};
  }
  throw ReadError(file.name(), "",
                  "columns are named, but this is not a text file of points: " + found.name,
                  "omit --columns");
}

}  // namespace

Scan read_scan(const std::filesystem::path& path, const ReadOptions& options) {
  InputFile file(path, options.progress, options.label);
  const Recognition recognition = recognise_for(file, options);
  try {
    Scan scan = read_recognised(file, path, recognition, options);
    if (options.progress) options.progress(1.0);
    return scan;
  } catch (const std::bad_alloc&) {
    throw ReadError(file.name(), "", "not enough memory for this scan",
                    "close other programs, or reduce the scan first");
  }
}

}  // namespace tactree::builder
