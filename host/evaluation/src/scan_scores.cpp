#include <random>

#include "errors.hpp"
#include "hole_map.hpp"
#include "measurements.hpp"
#include "reference_surface.hpp"
#include "scan_slides.hpp"
#include "tactree/builder/build_model.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/evaluation/shapes.hpp"

namespace tactree::evaluation {
namespace {

using Eigen::Vector3d;

constexpr int kProbesPerSlide = 25;

struct Comparison {
  Errors distance;
  Errors depth;
  Errors normal;

  void add(const core::SurfaceProjection& answer, const ReferenceSurface::Projection& truth) {
    distance.add((widen(answer.point) - truth.point).norm());
    depth.add(static_cast<double>(answer.signed_distance) - truth.signed_distance);
    normal.add(angle_deg(widen(answer.normal), truth.normal));
  }
  void report(const std::string& prefix, Scores& scores) const {
    scores.set(prefix + "distance_rms_m", distance.rms());
    scores.set(prefix + "distance_max_m", distance.largest());
    scores.set(prefix + "depth_rms_m", depth.rms());
    scores.set(prefix + "normal_rms_deg", normal.rms());
    scores.set(prefix + "normal_max_deg", normal.largest());
  }
};

void compare(const core::BlobView& view, const ReferenceSurface& reference, int probes,
             std::uint32_t seed, Scores& scores) {
  const auto spacing = static_cast<double>(view.header().spacing_m);
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::size_t> pick(0, reference.positions().size() - 1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Comparison all;
  Comparison smooth;
  for (int i = 0; i < probes; ++i) {
    const std::size_t at = pick(random);
    const double x = unit(random);
    const double y = unit(random);
    const Vector3d aside = 0.5 * spacing * Vector3d(x, y, unit(random));
    const Vector3d probe =
        reference.positions()[at] + aside + spacing * unit(random) * reference.normals()[at];
    const Vector3d rounded = widen(narrow(probe));
    const ReferenceSurface::Projection truth = reference.project(rounded);
    const core::SurfaceProjection answer = core::project_to_surface(view, narrow(probe));
    if (!truth.supported || !answer.supported) {
      continue;
    }
    all.add(answer, truth);
    if (!truth.creased) {
      smooth.add(answer, truth);
    }
  }
  all.report("", scores);
  smooth.report("smooth_", scores);
  const auto compared = static_cast<double>(all.distance.count());
  scores.set("creased", 1.0 - static_cast<double>(smooth.distance.count()) / compared);
  scores.set("answered", compared / probes);
}

}  // namespace

ScanResult score_scan(const std::filesystem::path& file, const Options& options) {
  const int probes = options.quick ? 500 : 5000;
  ScanResult result;
  result.name = file.filename().string();
  try {
    builder::Progress quiet;
    builder::BuildOptions build;
    build.centre = true;
    if (!options.scans_only) {
      build.fit_m = kModelEdge_m;
    }
    build.format = options.format;
    build.columns = options.columns;
    const builder::BuildResult built = builder::build_model(std::span(&file, 1), build, quiet);
    core::BlobView view;
    if (core::open_blob(built.blob.bytes, view) != core::BlobStatus::kOk ||
        core::surface_support(view) != core::SurfaceSupport::kOk) {
      throw std::runtime_error(file.string() +
                               ": surface mode cannot render this scan (it has too few points)");
    }
    const builder::BuildReport& report = built.report;
    result.input_points = report.input_points;
    result.kept_points = report.kept_points;
    result.dropped = report.dropped;
    result.orientation_checked = report.orientation.checked;
    result.orientation_confidence = report.orientation.confidence;
    result.doubtful_points = report.orientation.doubtful_points;
    result.pieces = report.orientation.pieces.size();
    result.notes = report.notes;
    result.warnings = report.warnings;
    result.points = view.point_count();
    result.spacing_m = built.report.spacing_m;
    result.bridged_m = builder::kBridgedSpacings * static_cast<double>(view.header().spacing_m);
    result.openings = built.report.openings;
    result.hole_map = hole_map_svg(view, result.openings);
    for (builder::Opening& opening : result.openings) {
      opening.centre += report.source_scale * report.source_origin;
    }
    const ReferenceSurface reference(view);
    compare(view, reference, probes, options.seed, result.scores);
    result.slides = slide_over(view, reference.positions(), probes / kProbesPerSlide, options.seed);
  } catch (const std::exception& error) {
    result.error = error.what();
  }
  return result;
}

}  // namespace tactree::evaluation
