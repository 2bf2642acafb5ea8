#include "tactree/builder/build_model.hpp"

#include <fmt/core.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "cleaning/cleaning.hpp"
#include "cleaning/colour_census.hpp"
#include "cleaning/turn.hpp"
#include "normals/given_normals.hpp"
#include "normals/mesh_windings.hpp"
#include "normals/normals.hpp"
#include "normals/orient_cloud.hpp"
#include "normals/report_orientation.hpp"
#include "octree/rounding.hpp"
#include "openings/gaps.hpp"
#include "openings/two_sided.hpp"
#include "sampling/ball_bound.hpp"
#include "sampling/density.hpp"
#include "source_digest.hpp"
#include "stage_times.hpp"
#include "tactree/builder/length_text.hpp"
#include "tactree/builder/read_scan.hpp"
#include "tactree/builder/size_advice.hpp"
#include "tactree/core/model/blob.hpp"
#include "up_hint.hpp"

namespace tactree::builder {
namespace {

class Pipeline {
 public:
  Pipeline(const BuildOptions& options, StageTimes& stages) : options_(options), stages_(stages) {}

  [[nodiscard]] BuildReport& report() { return report_; }
  /// Per point of the blob, after run(): 1 if its orientation is ambiguous.
  [[nodiscard]] std::vector<std::uint8_t>& doubtful() { return doubtful_of_blob_; }
  /// Per point of the blob, after run(), if they are kept.
  [[nodiscard]] std::vector<Colour>& colours() { return colours_of_blob_; }

  /// `digest` is called as late as possible, because it may wait for another thread.
  WrittenBlob run(std::vector<Scan> scans, const std::function<Sha256Digest()>& digest) {
    stages_.begin("cleaning");
    input_ = clean(std::move(scans), options_, report_);
    stages_.set_points(report_.input_points);
    advise_on_unit();
    stages_.begin("checking the orientation");
    stages_.set_points(report_.kept_points);
    check_given();
    model_.profile = options_.profile;
    model_.name = options_.name;
    model_.source_scale = report_.source_scale;
    model_.source_origin = report_.source_origin;
    if (options_.materials) {
      model_.materials = options_.materials->list();
    }
    stages_.begin("resampling");
    DensityChoice choice = choose_density(input_, options_, stages_, report_);
    stages_.set_points(choice.dense.size());
    model_.spacing_m = choice.spacing_m;
    model_.support_radius_m = kSupportSpacings * choice.spacing_m;
    model_.reach_m = kReachSpacings * choice.spacing_m;
    input_ = {};  // `choice` holds all further input
    find_normals(choice);
    if (options_.flip_normals) {
      flip(choice);
    }
    choice.dense = {};
    if (options_.two_sided_m) {
      make_two_sided(choice, *options_.two_sided_m);
    }
    begin_stage("finding gaps", choice);
    Gaps gaps = find_gaps(choice.points, model_.spacing_m, model_.support_radius_m, watertight_);
    model_.largest_gap_m = gaps.largest_m;
    report_.openings = std::move(gaps.openings);
    model_.source_digest = digest();
    Cloud points = choice.points.take();
    model_.positions = std::move(points.positions);
    model_.normals = std::move(points.normals);
    if (options_.pose) {
      place(*options_.pose);
    }
    WrittenBlob blob = write(points);
    hint_at_axis();
    return blob;
  }

 private:
  void begin_stage(std::string_view name, const DensityChoice& choice) {
    stages_.begin(name);
    stages_.set_points(choice.points.size());
  }

  void advise_on_unit() {
    const bool stated = options_.unit_m || options_.fit_m || options_.fit_edge_m || options_.pose;
    const std::optional<std::string> advice = size_advice(largest_edge(input_.bounds));
    if (advice && !stated) {
      report_.warnings.push_back(*advice);
    }
  }

  // Only if the shape indicates an axis and the user has not stated which axis points up. In the
  // axes of the file, to which --axis refers. The last use of the model, which is turned back.
  void hint_at_axis() {
    if (options_.up) {
      return;
    }
    Eigen::Matrix3d back = turn_about_z(-options_.turn_deg);
    if (options_.pose) {
      back = back * options_.pose->linear().transpose();
    }
    std::vector<Opening> openings = report_.openings;
    if (options_.turn_deg != 0.0 || options_.pose) {
      for (std::size_t i = 0; i < model_.positions.size(); ++i) {
        model_.positions[i] = back * model_.positions[i];
        model_.normals[i] = back.cast<float>() * model_.normals[i];
      }
      for (Opening& opening : openings) {
        opening.centre = back * opening.centre;
      }
    }
    const auto posture = lying_posture(model_.positions, model_.normals, openings, model_.spacing_m,
                                       report_.backed_share < kBodyShare);
    if (posture) {
      report_.notes.push_back(fmt::format("{} ({}; --axis z keeps it as it is)",
                                          describe_lying(*posture), describe_turn(*posture)));
    }
  }

  // Before the points are chosen: points on two sides of a plate do not compete.
  void check_given() {
    for (const Eigen::Vector3d& viewpoint : options_.viewpoints) {
      viewpoints_.push_back(input_.frame.placed(viewpoint));
    }
    const std::vector<Sight>& sights = input_.points.cloud().sights;
    const bool seen = std::any_of(sights.begin(), sights.end(),
                                  [](const Sight& sight) { return !sight.toward.isZero(); });
    if (options_.orient == OrientationRule::kViewpoint && viewpoints_.empty() && !seen) {
      throw std::runtime_error(
          "--orient viewpoint needs the position of the scanner, and the input has none (give "
          "--viewpoint X,Y,Z)");
    }
    mesh_ = !input_.mesh.triangles.empty();
    if (options_.orient == OrientationRule::kGiven) {
      return;
    }
    if (mesh_) {
      const WindingRepair repair = repair_windings(input_.mesh, options_.orient, viewpoints_);
      watertight_ =
          repair.watertight && input_.points.size() == 0 && !options_.crop && !options_.two_sided_m;
      if (!options_.two_sided_m) {
        report_windings(repair, input_.mesh.triangles.size(), report_);
      }
    }
    if (signs_are_random(input_.points, input_.points_spacing)) {
      input_.points.set_normals({});
      report_.warnings.emplace_back(
          "the normals of the file contradict each other and are estimated instead (--orient given "
          "keeps them)");
    }
  }

  void find_normals(DensityChoice& choice) {
    const ZOrderedCloud& points = choice.points;
    std::vector<std::uint8_t> given(points.size(), 0);
    std::size_t count = 0;
    for (std::size_t i = 0; i < points.size() && points.cloud().has_normals(); ++i) {
      given[i] = points.normals()[i].isZero() ? 0 : 1;
      count += given[i];
    }
    const bool all = count == points.size();
    if (all && (mesh_ || options_.orient == OrientationRule::kGiven)) {
      return;
    }
    std::vector<Eigen::Vector3f> normals = points.normals();
    if (!all) {
      begin_stage("estimating normals", choice);
      normals = estimate_normals(points, choice.dense, model_.spacing_m, input_spacing(choice));
    }
    if (!needs_dense(input_spacing(choice), model_.spacing_m)) {
      choice.dense = {};
    }
    begin_stage("orienting normals", choice);
    orient(choice, given, normals);
    if (!all) {
      report_.notes.push_back(fmt::format(
          "{} of {} normals are estimated; the surface has {} connected component{}",
          points.size() - count, points.size(), report_.pieces, report_.pieces == 1 ? "" : "s"));
    }
    choice.points.set_normals(std::move(normals));
  }

  static void flip(DensityChoice& choice) {
    std::vector<Eigen::Vector3f> normals = choice.points.normals();
    for (Eigen::Vector3f& normal : normals) {
      normal = -normal;
    }
    choice.points.set_normals(std::move(normals));
  }

  void orient(const DensityChoice& choice, std::span<const std::uint8_t> given,
              std::span<Eigen::Vector3f> normals) {
    const bool keep = options_.orient == OrientationRule::kGiven;
    std::vector<Eigen::Vector3f> before;
    if (keep) {
      before.assign(normals.begin(), normals.end());
    }
    CloudOrientation orientation = orient_cloud({.points = choice.points,
                                                 .spacing = model_.spacing_m,
                                                 .dense = choice.dense,
                                                 .dense_spacing = input_spacing(choice),
                                                 .rule = options_.orient,
                                                 .viewpoints = viewpoints_,
                                                 .given = given},
                                                normals);
    for (std::size_t i = 0; i < normals.size() && keep; ++i) {
      if (given[i] != 0) {
        normals[i] = before[i];
      }
    }
    report_.pieces = static_cast<std::uint32_t>(orientation.pieces.size());
    if (!options_.two_sided_m) {
      report_orientation(orientation, keep ? 0 : orientation.repaired, report_);
      doubtful_ = std::move(orientation.doubtful);
    }
  }

  void make_two_sided(DensityChoice& choice, double thickness) {
    const double h = model_.spacing_m;
    if (!(thickness >= h)) {
      throw std::runtime_error(fmt::format(
          "--two-sided {}: the sheet must be at least as thick as the spacing of its points, {} "
          "(raise it, or lower --spacing)",
          length_text(thickness), length_text(h)));
    }
    Thickened body = thicken(choice.points, h, model_.support_radius_m, thickness);
    choice.points = std::move(body.points);
    if (options_.profile == core::Profile::kSurface) {
      report_.thinned += thin_to_candidates(choice.points, h);
    }
    report_.notes.push_back(
        fmt::format("the sheet is a body of {} thickness, with {} points on its two sides and {} "
                    "around its edges",
                    length_text(thickness), choice.points.size() - body.at_edge, body.at_edge));
  }

  /// The last step, after all that depends on the axes of the model before: the same points.
  void place(const Eigen::Isometry3d& pose) {
    for (Eigen::Vector3d& position : model_.positions) {
      position = pose * position;
    }
    const Eigen::Matrix3f turn = pose.linear().cast<float>();
    for (Eigen::Vector3f& normal : model_.normals) {
      normal = (turn * normal).normalized();
    }
    for (Opening& opening : report_.openings) {
      opening.centre = pose * opening.centre;
    }
    for (OrientedPiece& piece : report_.orientation.pieces) {
      piece.centre = pose * piece.centre;
    }
    report_.notes.emplace_back(
        "the model is placed in the frame of the device (simulate and view it with --origin 0 0 "
        "0)");
  }

  static double input_spacing(const DensityChoice& choice) {
    return choice.dense_spacing_m > 0.0 ? choice.dense_spacing_m : choice.spacing_m;
  }

  /// `points`: the materials, colours and doubts of the points of the model.
  WrittenBlob write(const Cloud& points) {
    stages_.begin("writing the octree");
    stages_.set_points(model_.positions.size());
    model_.material_indices = points.materials;
    model_.tells_interior = true;
    const bool as_given = doubtful_.empty() && !options_.two_sided_m;
    model_.doubtful = as_given ? points.doubtful : doubtful_;
    WrittenBlob blob = write_blob(model_);
    check(blob);
    if (options_.flash_budget_bytes) {
      check_budget(blob.bytes.size(), *options_.flash_budget_bytes);
    }
    count_materials(blob);
    collect_doubtful(blob);
    collect_colours(blob, points);
    report_.spacing_m = model_.spacing_m;
    report_.largest_gap_m = model_.largest_gap_m;
    report_.merged = blob.merged;
    report_.backed_share = blob.backed_share;
    report_.output_points = blob.source_index.size();
    report_.bounds = bounds_of(model_.positions);
    report_.bytes = blob.bytes.size();
    return blob;
  }

  /// The spacing was chosen before the sheet was thickened.
  void check_budget(std::uint64_t bytes, std::uint64_t budget) {
    if (bytes > budget) {
      throw std::runtime_error(
          fmt::format("the model takes {} bytes, more than the flash budget of {} (lower "
                      "--flash-budget by the difference)",
                      bytes, budget));
    }
    const double part = 100.0 * static_cast<double>(bytes) / static_cast<double>(budget);
    report_.notes.push_back(fmt::format(
        "the flash budget of {} bytes allows a spacing of {}: {} bytes, {:.1f} % of the budget{}",
        budget, length_text(model_.spacing_m), bytes, part,
        part < 90.0 && !mesh_ ? "; the scan has no finer detail" : ""));
  }

  void collect_doubtful(const WrittenBlob& blob) {
    const std::vector<std::uint8_t>& doubtful = model_.doubtful;
    doubtful_of_blob_.assign(blob.source_index.size(), 0);
    for (std::size_t i = 0; i < doubtful_of_blob_.size() && !doubtful.empty(); ++i) {
      doubtful_of_blob_[i] = doubtful[blob.source_index[i]];
    }
  }

  void collect_colours(const WrittenBlob& blob, const Cloud& cloud) {
    if (!cloud.has_colours()) {
      return;
    }
    colours_of_blob_.reserve(blob.source_index.size());
    for (const std::uint32_t source : blob.source_index) {
      colours_of_blob_.push_back(cloud.colours[source]);
    }
  }

  void count_materials(const WrittenBlob& blob) {
    report_.material_points.assign(model_.materials.size(), 0);
    for (const std::uint32_t source : blob.source_index) {
      if (!model_.materials.empty()) {
        ++report_
              .material_points[model_.material_indices.empty() ? 0
                                                               : model_.material_indices[source]];
      }
    }
    for (std::size_t i = 1; i < report_.material_points.size(); ++i) {
      if (report_.material_points[i] == 0) {
        report_.warnings.push_back(unused_colour(options_.materials->colours[i - 1],
                                                 report_.colour_matches[i - 1], report_.colours));
      }
    }
  }

  // Decodes the blob as the board does and compares the positions.
  void check(const WrittenBlob& blob) const {
    core::BlobView view;
    const core::BlobStatus status = core::open_blob(blob.bytes, view);
    if (status != core::BlobStatus::kOk || view.point_count() != blob.source_index.size()) {
      throw std::logic_error(
          fmt::format("internal error: the written blob is not valid: {}", core::describe(status)));
    }
    core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
      const core::Vec3 p = view.position(leaf, index);
      const Eigen::Vector3d decoded(static_cast<double>(p.x), static_cast<double>(p.y),
                                    static_cast<double>(p.z));
      const double off =
          (decoded - model_.positions[blob.source_index[index]]).cwiseAbs().maxCoeff();
      const double site = std::ldexp(static_cast<double>(2.0F * view.step_m()),
                                     static_cast<int>(view.depth() - leaf.level));
      const double reach = options_.profile == core::Profile::kSurface ? kSiteReach : 0.5;
      if (!(off <= 1.0001 * reach * site)) {
        throw std::logic_error(fmt::format(
            "internal error: point {} of the written blob is displaced by {} m", index, off));
      }
    });
  }

  const BuildOptions& options_;
  StageTimes& stages_;
  BuildReport report_;
  CleanInput input_;
  bool mesh_ = false;                        // some points lie on faces
  bool watertight_ = false;                  // all points lie on the faces of closed shells
  std::vector<Eigen::Vector3d> viewpoints_;  // in the model frame
  Model model_;
  std::vector<std::uint8_t> doubtful_;  // per point of the model; empty: none
  std::vector<std::uint8_t> doubtful_of_blob_;
  std::vector<Colour> colours_of_blob_;
};

// A build at the spacing of the cloud takes this much for each point of the scan; at wider ones it
// takes less.
constexpr std::uint64_t kBytesPerPoint = 220;
constexpr std::uint64_t kProgramBytes = 24U << 20U;  // without points
constexpr std::uint64_t kLeastPoints = 1000;

std::uint64_t memory_limit(const BuildOptions& options) {
  if (options.memory_limit_bytes != 0) {
    return options.memory_limit_bytes;
  }
  const auto pages = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES));
  return pages / 2 * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

// The number of points that may be read of each file: shares of the memory by the sizes of the
// files.
std::vector<std::uint64_t> most_points(std::span<const std::filesystem::path> files,
                                       const BuildOptions& options) {
  std::vector<double> sizes;
  double all = 0.0;
  for (const std::filesystem::path& file : files) {
    std::error_code unreadable;  // the reader says so
    const std::uintmax_t size = std::filesystem::file_size(file, unreadable);
    sizes.push_back(unreadable ? 0.0 : static_cast<double>(size));
    all += sizes.back();
  }
  const std::uint64_t limit = memory_limit(options);
  const auto points =
      static_cast<double>((limit - std::min(limit, kProgramBytes)) / kBytesPerPoint);
  std::vector<std::uint64_t> most;
  for (const double size : sizes) {
    const double share = all > 0.0 ? size / all : 1.0;
    most.push_back(std::max(kLeastPoints, static_cast<std::uint64_t>(share * points)));
  }
  return most;
}

std::unique_ptr<tbb::global_control> limit_threads(unsigned threads) {
  return threads == 0 ? nullptr
                      : std::make_unique<tbb::global_control>(
                            tbb::global_control::max_allowed_parallelism, threads);
}

BuildResult finish(Pipeline& pipeline, std::vector<Scan> scans,
                   const std::function<Sha256Digest()>& digest, const std::string& label,
                   StageTimes& stages) {
  try {
    BuildResult result;
    result.blob = pipeline.run(std::move(scans), digest);
    result.report = std::move(pipeline.report());
    result.doubtful = std::move(pipeline.doubtful());
    result.colours = std::move(pipeline.colours());
    stages.end();
    result.report.stages = stages.stages();
    result.report.seconds = stages.seconds();
    result.report.peak_rss_bytes = usage_of_process().peak_rss_bytes;
    return result;
  } catch (const std::runtime_error& error) {
    throw BuildError(label.empty() ? error.what() : label + ": " + error.what());
  }
}

bool is_standard_input(const std::filesystem::path& file, const BuildOptions& options) {
  return file == "-" && !options.standard_input.empty();
}

std::string label_of(const std::filesystem::path& file, const BuildOptions& options) {
  return is_standard_input(file, options) ? "standard input" : file.string();
}

std::string label_of(std::span<const std::filesystem::path> inputs, const BuildOptions& options) {
  const std::string first = label_of(inputs[0], options);
  return inputs.size() == 1 ? first : fmt::format("{} and {} more", first, inputs.size() - 1);
}

/// Paths of the files, with that of the copy for standard input.
std::vector<std::filesystem::path> places_of(std::span<const std::filesystem::path> inputs,
                                             const BuildOptions& options) {
  std::vector<std::filesystem::path> places(inputs.begin(), inputs.end());
  for (std::filesystem::path& place : places) {
    place = is_standard_input(place, options) ? options.standard_input : place;
  }
  return places;
}

}  // namespace

BuildResult build_model(std::span<const std::filesystem::path> inputs, const BuildOptions& options,
                        Progress& progress) {
  if (inputs.empty()) {
    throw BuildError("no input file");
  }
  StageTimes stages(progress);
  const auto limit = limit_threads(options.threads);
  const std::vector<std::filesystem::path> places = places_of(inputs, options);
  SourceDigest digest(places, options.threads != 1);
  BuildOptions named = options;
  if (named.name.empty()) {
    named.name = is_standard_input(inputs[0], options) ? "stdin" : inputs[0].stem().string();
  }
  Pipeline pipeline(named, stages);
  std::vector<Scan> scans;
  const std::vector<std::uint64_t> most = most_points(places, options);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string label = label_of(inputs[i], options);
    stages.begin("reading " + std::filesystem::path(label).filename().string());
    ReadOptions reading;
    reading.format = options.format;
    reading.label = label;
    reading.progress = [&](double fraction) { stages.advance(fraction); };
    reading.columns = options.columns;
    reading.most_points = most[i];
    scans.push_back(read_scan(places[i], reading));
    const Scan& scan = scans.back();
    const auto thinned = scan.dropped.find(kBeyondMemoryLimit);
    const std::uint64_t points =
        scan.positions.size() + (thinned == scan.dropped.end() ? 0 : thinned->second);
    stages.set_points(points);
    pipeline.report().inputs.push_back({label, scan.format, points, scan.triangles.size()});
  }
  return finish(
      pipeline, std::move(scans), [&] { return digest.get(); }, label_of(inputs, options), stages);
}

BuildResult build_model(std::vector<Scan> scans, const BuildOptions& options, Progress& progress) {
  StageTimes stages(progress);
  const auto limit = limit_threads(options.threads);
  Pipeline pipeline(options, stages);
  return finish(
      pipeline, std::move(scans), [] { return Sha256Digest{}; }, "", stages);
}

}  // namespace tactree::builder
