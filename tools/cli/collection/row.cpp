#include "collection/row.hpp"

#include <fstream>

#include "tactree/builder/report_json.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;

fs::path beside(const fs::path& output, const std::string& name, const char* ending) {
  return output / (name + ending);
}

}  // namespace

ObjectFiles::ObjectFiles(const fs::path& output, const CollectionObject& object)
    : blob(beside(output, object.name, ".blob")),
      preview(beside(output, object.name, ".png")),
      row(beside(output, object.name, ".json")) {}

ObjectRow row_of_failure(const CollectionObject& object, const std::string& digest,
                         const std::string& error) {
  return {{"name", object.name},
          {"result", kResultFailed},
          {"input", object.input.string()},
          {"digest", digest},
          {"error", error}};
}

ObjectRow row_of_build(const CollectionObject& object, const std::string& digest,
                       const std::string& blob_digest, const builder::BuildReport& report,
                       const builder::BuildOptions& build) {
  std::size_t holes = 0;
  for (const builder::Opening& opening : report.openings) {
    holes += opening.kind == builder::Opening::Kind::kHole ? 1 : 0;
  }
  const bool ambiguous = report.orientation.doubtful_points > 0;
  const Eigen::Vector3d size = report.bounds.sizes();
  return {{"name", object.name},
          {"result", ambiguous ? kResultAmbiguous : kResultOk},
          {"input", object.input.string()},
          {"digest", digest},
          {"blob_digest", blob_digest},
          {"bytes", report.bytes},
          {"points", report.output_points},
          {"spacing_m", report.spacing_m},
          {"size_x_m", size.x()},
          {"size_y_m", size.y()},
          {"size_z_m", size.z()},
          {"confidence", report.orientation.confidence},
          {"ambiguous_points", report.orientation.doubtful_points},
          {"holes", holes},
          {"open_boundaries", report.openings.size() - holes},
          {"largest_gap_m", report.largest_gap_m},
          {"seconds", report.seconds},
          {"warnings", report.warnings},
          {"report", ObjectRow::parse(builder::report_json(report, build))}};
}

std::optional<ObjectRow> read_row(const ObjectFiles& files) {
  std::ifstream in(files.row);
  ObjectRow row = ObjectRow::parse(in, nullptr, false);
  return row.is_object() ? std::optional(std::move(row)) : std::nullopt;
}

std::string text_of(const ObjectRow& row, const char* key) {
  const auto found = row.find(key);
  return found != row.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace tactree::cli
