#include <fmt/core.h>

#include <cstdio>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.hpp"
#include "option_checks.hpp"
#include "scan/read_points.hpp"
#include "tactree/builder/length_text.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/point_query.hpp"
#include "tactree/support/spooled_input.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

using core::Vec3;

struct QueryOptions {
  std::string blob;
  std::string points;
  std::string json;
  std::optional<double> radius_m;
};

void append_row(std::string& out, Vec3 probe, const support::PointAnswer& a) {
  auto to = std::back_inserter(out);
  fmt::format_to(to, "{:.9g},{:.9g},{:.9g},{:d},{:d},", probe.x, probe.y, probe.z, a.contact_paper,
                 a.contact);
  if (a.nearest == core::kNoPoint) {
    fmt::format_to(to, "-1,,");
  } else {
    fmt::format_to(to, "{},{:.9g},", a.nearest, a.distance_m);
  }
  if (!a.surface.supported) {
    fmt::format_to(to, ",,,,,,");
  } else {
    const core::SurfaceProjection& s = a.surface;
    fmt::format_to(to, "{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", s.point.x, s.point.y,
                   s.point.z, s.normal.x, s.normal.y, s.normal.z, s.signed_distance);
  }
  fmt::format_to(to, ",{}\n", a.inside ? (*a.inside ? "1" : "0") : "");
}

struct Totals {
  std::size_t rows = 0;
  std::size_t contacts_paper = 0;
  std::size_t contacts = 0;
  std::size_t found = 0;
  std::size_t supported = 0;
};

void print_rows(std::string& rows) {
  if (std::fwrite(rows.data(), 1, rows.size(), stdout) != rows.size()) {
    throw support::UserError("standard output cannot be written (check the disk or the pipe)");
  }
  rows.clear();
}

Totals answer_all(support::PointQuery& query, const std::vector<std::array<double, 3>>& rows) {
  Totals totals;
  std::string out =
      "x,y,z,contact_paper,contact,nearest,distance_m,surface_x,surface_y,surface_z,normal_x,"
      "normal_y,normal_z,signed_distance_m,inside\n";
  for (const auto& row : rows) {
    const Vec3 probe{static_cast<float>(row[0]), static_cast<float>(row[1]),
                     static_cast<float>(row[2])};
    const support::PointAnswer answer = query.answer(probe);
    append_row(out, probe, answer);
    ++totals.rows;
    totals.contacts_paper += answer.contact_paper ? 1U : 0U;
    totals.contacts += answer.contact ? 1U : 0U;
    totals.found += answer.nearest != core::kNoPoint ? 1U : 0U;
    totals.supported += answer.surface.supported ? 1U : 0U;
    if (out.size() > (1U << 20)) {
      print_rows(out);
    }
  }
  print_rows(out);
  return totals;
}

void query(const QueryOptions& options) {
  if (options.blob == support::kStandardInput && options.points == support::kStandardInput) {
    throw CLI::ValidationError("--points", "'-' (standard input) is already used for the blob");
  }
  support::check_outputs({options.json}, {options.blob, options.points});
  const support::BlobFile blob = support::BlobFile::named(options.blob);
  const auto rows = read_points(options.points);
  const float radius = options.radius_m ? static_cast<float>(*options.radius_m)
                                        : support::default_query_radius_m(blob.view());
  support::PointQuery engine(blob.view(), radius);
  if (engine.exhaustive()) {
    fmt::print(stderr,
               "tactree: note: the radius exceeds the blob's reach of {}: searching all points, "
               "unlike a controller\n",
               builder::length_text(static_cast<double>(blob.view().reach_m()), 6));
  }
  const Totals totals = answer_all(engine, rows);
  if (!options.json.empty()) {
    const nlohmann::json result{{"rows", totals.rows},
                                {"radius_m", radius},
                                {"contacts_paper", totals.contacts_paper},
                                {"contacts", totals.contacts},
                                {"nearest_found", totals.found},
                                {"surface_found", totals.supported}};
    support::write_file(options.json, support::json_text(result));
  }
}

}  // namespace

void add_query_command(CLI::App& app, int&) {
  auto options = std::make_shared<QueryOptions>();
  CLI::App* verb = app.add_subcommand(
      "query",
      "Prints contact, nearest point and surface for positions as CSV:\n"
      "x,y,z,contact_paper,contact,nearest,distance_m,surface_{x,y,z},normal_{x,y,z},signed_"
      "distance_m,inside (1: in the material; empty: the blob does not state it)");
  verb->add_option("BLOB", options->blob, "blob to query; -: standard input")->required();
  verb->add_option("--points", options->points,
                   "CSV file with rows x,y,z, or with a line that names these columns (m, model "
                   "frame); -: standard input")
      ->required();
  verb->add_option("--radius", options->radius_m,
                   "search radius for the nearest point, m (default: the support radius)")
      ->check(is_not_negative);
  verb->add_option("--json", options->json, "write counts as JSON to this file");
  verb->callback([options] { query(*options); });
}

}  // namespace tactree::cli
