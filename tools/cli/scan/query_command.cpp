#include <fmt/core.h>

#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.hpp"
#include "option_checks.hpp"
#include "scan/read_points.hpp"
#include "tactree/builder/length_text.hpp"
#include "tactree/core/contact/paper_mode.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/core/model/interior.hpp"
#include "tactree/core/model/nearest.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/spooled_input.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

using core::BlobView;
using core::Vec3;

struct QueryOptions {
  std::string blob;
  std::string points;
  std::string json;
  std::optional<double> radius_m;
};

struct QueryResult {
  bool contact_paper = false;
  bool contact = false;
  std::uint32_t nearest = core::kNoPoint;
  double distance_m = 0.0;
  core::SurfaceProjection surface;
  std::optional<bool> inside;  // empty if the blob does not contain an interior
};

// The queries of the controller, which are exact up to the reach of the blob. For larger radii,
// which a controller never uses, all points are searched.
class Query {
 public:
  Query(const BlobView& view, float radius_m)
      : view_(view),
        radius_m_(radius_m),
        nearest_exact_(radius_m <= view.reach_m()),
        boxes_exact_(0.5F * view.header().aabb_edge_m <= view.reach_m()),
        has_surface_(core::surface_support(view) == core::SurfaceSupport::kOk) {
    if (!nearest_exact_ || !boxes_exact_) {
      points_ = support::decode_points(view);
    }
  }

  [[nodiscard]] bool exhaustive() const { return !points_.empty(); }

  QueryResult answer(Vec3 probe) {
    QueryResult result;
    result.contact_paper = core::paper_collision(view_, probe).in_contact;
    result.contact = boxes_exact_ ? core::in_any_vertex_box(view_, probe) : in_any_box(probe);
    const core::NearestPoint nearest =
        nearest_exact_ ? core::nearest_within(view_, probe, radius_m_) : nearest_of_all(probe);
    result.nearest = nearest.index;
    result.distance_m = std::sqrt(static_cast<double>(nearest.distance_squared));
    if (has_surface_) {
      result.surface = core::project_to_surface(view_, probe, candidates_);
    }
    if (view_.interior() != nullptr) {
      result.inside = is_in_material(probe, result.surface);
    }
    return result;
  }

 private:
  /// Uses the rule of Proxy::inside(). Precondition: candidates_ are those of the projection.
  [[nodiscard]] bool is_in_material(Vec3 probe, const core::SurfaceProjection& surface) const {
    if (!surface.supported) {
      return core::interior_at(view_, probe).here;
    }
    return surface.signed_distance < 0.0F &&
           core::interior_at(view_, candidates_[0].position).behind;
  }

  [[nodiscard]] bool in_any_box(Vec3 probe) const {
    const float half = 0.5F * view_.header().aabb_edge_m;
    for (const core::SurfacePoint& p : points_) {
      const Vec3 d = p.position - probe;
      if (std::abs(d.x) <= half && std::abs(d.y) <= half && std::abs(d.z) <= half) {
        return true;
      }
    }
    return false;
  }

  [[nodiscard]] core::NearestPoint nearest_of_all(Vec3 probe) const {
    core::NearestPoint best;
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const float squared = length_squared(points_[i].position - probe);
      if (squared <= radius_m_ * radius_m_ && (!best.found() || squared < best.distance_squared)) {
        best.index = i;
        best.distance_squared = squared;
      }
    }
    return best;
  }

  BlobView view_;
  float radius_m_;
  bool nearest_exact_;
  bool boxes_exact_;
  bool has_surface_;
  std::vector<core::SurfacePoint> points_;
  core::CandidateSet candidates_;
};

void append_row(std::string& out, Vec3 probe, const QueryResult& a) {
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

Totals answer_all(Query& query, const std::vector<std::array<double, 3>>& rows) {
  Totals totals;
  std::string out =
      "x,y,z,contact_paper,contact,nearest,distance_m,surface_x,surface_y,surface_z,normal_x,"
      "normal_y,normal_z,signed_distance_m,inside\n";
  for (const auto& row : rows) {
    const Vec3 probe{static_cast<float>(row[0]), static_cast<float>(row[1]),
                     static_cast<float>(row[2])};
    const QueryResult answer = query.answer(probe);
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
  const core::BlobHeader& header = blob.view().header();
  const float radius = options.radius_m ? static_cast<float>(*options.radius_m)
                                        : (header.support_radius_m > 0.0F ? header.support_radius_m
                                                                          : header.reach_m);
  Query engine(blob.view(), radius);
  if (engine.exhaustive()) {
    fmt::print(stderr,
               "tactree: note: the radius exceeds the blob's reach of {}: searching all points, "
               "unlike a controller\n",
               builder::length_text(static_cast<double>(header.reach_m), 6));
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
                   "CSV file with rows x,y,z (m, model frame); -: standard input")
      ->required();
  verb->add_option("--radius", options->radius_m,
                   "search radius for the nearest point, m (default: the support radius)")
      ->check(is_not_negative);
  verb->add_option("--json", options->json, "write counts as JSON to this file");
  verb->callback([options] { query(*options); });
}

}  // namespace tactree::cli
