#include "cleaning/cleaning.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "cleaning/colour_census.hpp"
#include "cleaning/outliers.hpp"
#include "cleaning/pieces.hpp"
#include "cleaning/scanner_poses.hpp"
#include "cleaning/stray_points.hpp"
#include "cleaning/turn.hpp"
#include "geometry/spacing.hpp"
#include "tactree/builder/length_text.hpp"

namespace tactree::builder {
namespace {

// Outliers of a cloud lie farther away than 10 times the size of its bulk, vertices of a mesh
// farther than 100 times, because a detailed figure may stand on a large, coarse plinth.
constexpr double kCloudMargin = 10.0;
constexpr double kMeshMargin = 100.0;
// Distance from the origin, in extents, beyond which float32 loses detail.
constexpr double kFarExtents = 4.0;
// Points closer to each other than this, in spacings, belong to the same component of a scan.
constexpr double kIslandSpacings = 2.5;
// Coordinate steps above this, relative to the spacing, can be felt: noise of 5 % makes force steps
// of 0.06 N on the cosine sheet of docs/RESULTS.md, which has 0.003 N without noise.
constexpr double kMaxStepPerDetail = 0.05;
constexpr double kDetailsPerExtent = 200.0;  // the default spacing of a mesh is its extent / 200
// Larger coordinates are treated as damage. Squares of distances would overflow only far beyond.
constexpr double kMaxCoordinate_m = 1e12;
// Range of extents that the lattice of a blob can represent at a useful spacing.
constexpr double kMinModel_m = 1e-6;
constexpr double kMaxModel_m = 1e6;
// Vertices of a mesh in no face, without a warning.
constexpr double kMaxUnusedPart = 0.1;
constexpr std::size_t kMaxUnused = 100;
constexpr std::size_t kColoursReported = 5;

// Returns false for NaN.
bool is_float(double value) { return static_cast<double>(static_cast<float>(value)) == value; }

bool is_in_range(const Eigen::Vector3d& position_m) {
  return position_m.cwiseAbs().maxCoeff() <= kMaxCoordinate_m;
}

class Cleaner {
 public:
  Cleaner(const BuildOptions& options, BuildReport& report) : options_(options), report_(report) {
    input_.frame.turn = turn_about_z(options.turn_deg) * turn_up(options.up.value_or(UpAxis::kZ));
  }

  CleanInput run(std::vector<Scan> scans) {
    require_colours(scans);
    choose_unit(scans);
    if (std::any_of(scans.begin(), scans.end(), [](const Scan& s) { return !s.poses.empty(); })) {
      cloud_sights_ = uses_poses();
    }
    for (Scan& scan : scans) {
      count_input(scan);
      count_colours(scan);
      note_float_steps(scan);
      if (scan.is_mesh()) {
        add_mesh(std::move(scan));
      } else {
        add_cloud(std::move(scan));
      }
      scan = Scan();
    }
    clean_mesh();
    clean_cloud();
    report_.kept_points = input_.points.size() + mesh_corners_;
    if (input_.points.size() == 0 && input_.mesh.triangles.empty()) {
      throw std::runtime_error(nothing_left());
    }
    place();
    warn_of_float_steps();
    report_.colours = census_.most_frequent(kColoursReported);
    report_.colour_matches = census_.matches();
    return std::move(input_);
  }

 private:
  // Uses the unit of the first scan and converts the others to it.
  void choose_unit(std::vector<Scan>& scans) {
    const double own = scans.empty() ? 1.0 : scans[0].unit_m.value_or(1.0);
    const double unit_m = options_.unit_m.value_or(own);
    input_.frame.unit = unit_m * options_.scale;
    report_.unit_known =
        options_.unit_m.has_value() || (!scans.empty() && scans[0].unit_m.has_value());
    for (Scan& scan : scans) {
      const double factor = options_.unit_m ? 1.0 : scan.unit_m.value_or(1.0) / unit_m;
      for (std::size_t i = 0; i < scan.positions.size() && factor != 1.0; ++i) {
        scan.positions[i] *= factor;
      }
      for (ScannerPose& pose : scan.poses) {
        pose.position *= factor;
      }
    }
    if (unit_m != 1.0 && !options_.unit_m) {
      report_.notes.push_back(
          fmt::format("the unit of the file is {} (--unit overrides it)", length_text(unit_m)));
    }
    if (options_.crop) {
      const double unit = input_.frame.unit;
      input_.crop = {
          Box((unit * options_.crop->min()).eval(), (unit * options_.crop->max()).eval()),
          input_.frame.turn};
    }
  }

  void drop(const std::string& cause, std::uint64_t count) {
    if (count > 0) {
      report_.dropped[cause] += count;
    }
  }

  void count_input(const Scan& scan) {
    report_.input_points += scan.positions.size();
    for (const auto& [cause, count] : scan.dropped) {
      drop(cause, count);
      report_.input_points += cause.find("face") == std::string::npos ? count : 0;
    }
    report_.warnings.insert(report_.warnings.end(), scan.warnings.begin(), scan.warnings.end());
    report_.notes.insert(report_.notes.end(), scan.notes.begin(), scan.notes.end());
  }

  [[nodiscard]] bool keep_outliers() const { return !(options_.outlier_sigma > 0.0); }

  [[nodiscard]] bool by_colour() const {
    return options_.materials && options_.materials->by_colour();
  }

  void require_colours(const std::vector<Scan>& scans) {
    const bool coloured = std::any_of(scans.begin(), scans.end(),
                                      [](const Scan& scan) { return !scan.colours.empty(); });
    if (by_colour() && !coloured) {
      throw std::runtime_error(
          "the materials depend on colour, but no input has colours at its points (export the scan "
          "with vertex colours, or give one material for the whole model)");
    }
    if (options_.keep_colours == KeepColours::kRequire && !coloured) {
      throw std::runtime_error(
          "--colours: no input has colours at its points (export the scan with vertex colours, or "
          "omit the option)");
    }
    keeps_colours_ = options_.keep_colours != KeepColours::kNo && coloured;
  }

  static const Colour& colour_of(const Scan& scan, std::size_t point) {
    return scan.colours.empty() ? kNoColour : scan.colours[point];
  }

  /// Points of a scan without colours get the base material.
  [[nodiscard]] std::uint8_t material_of(const Scan& scan, std::size_t point) {
    return scan.colours.empty() ? std::uint8_t{0}
                                : census_.take(scan.colours[point], *options_.materials);
  }

  /// Without materials, the report still states the colours for which a user may want some.
  void count_colours(const Scan& scan) {
    if (by_colour()) {
      return;  // material_of() counts
    }
    const MaterialMap none;
    for (const Colour& colour : scan.colours) {
      (void)census_.take(colour, none);
    }
  }

  [[nodiscard]] bool uses_poses() const {
    return options_.viewpoints.empty() && (options_.orient == OrientationRule::kAuto ||
                                           options_.orient == OrientationRule::kViewpoint);
  }

  // Direction from point i, at `position` in the turned frame, to its scanner.
  [[nodiscard]] Sight sight_of(const Scan& scan, std::size_t i,
                               const Eigen::Vector3d& position) const {
    const auto next = std::upper_bound(
        scan.poses.begin(), scan.poses.end(), i,
        [](std::size_t point, const ScannerPose& pose) { return point < pose.first_point; });
    if (next == scan.poses.begin()) {
      return {};
    }
    const ScannerPose& pose = *std::prev(next);
    const Eigen::Vector3d d = input_.frame.turned(pose.position) - position;
    const double range = d.norm();
    return range > 0.0 ? Sight{(d / range).cast<float>(), pose.sure} : Sight{};  // also for NaN
  }

  // Appends the positions of the scan to those of the cloud, without a copy if they are the first.
  // Returns the number of positions before.
  std::size_t take_positions(Scan& scan) {
    const std::size_t before = cloud_.size();
    if (before == 0) {
      cloud_.positions = std::move(scan.positions);
      if (cloud_.positions.capacity() > 2 * cloud_.size()) {  // it was thinned while it was read
        cloud_.positions.shrink_to_fit();
      }
    } else {
      cloud_.positions.insert(cloud_.positions.end(), scan.positions.begin(), scan.positions.end());
    }
    scan.positions = {};
    return before;
  }

  void add_cloud(Scan&& scan) {
    if (cloud_sights_) {
      check_poses(scan, report_);
    }
    const bool normals = scan.normals.size() == scan.positions.size();
    std::uint64_t non_finite = 0;
    std::uint64_t out_of_range = 0;
    std::uint64_t outside = 0;
    std::size_t kept = cloud_.size();
    if (normals || cloud_.has_normals()) {
      cloud_.normals.resize(kept, Eigen::Vector3f::Zero());
      cloud_.normals.reserve(kept + scan.positions.size());
    }
    const std::size_t first = take_positions(scan);
    for (std::size_t i = 0; first + i < cloud_.size(); ++i) {
      const Eigen::Vector3d source = cloud_.positions[first + i];
      const Eigen::Vector3d p = input_.frame.turned(source);
      if (!p.allFinite()) {
        ++non_finite;
      } else if (!is_in_range(p)) {
        ++out_of_range;
      } else if (options_.crop && !options_.crop->contains(source)) {
        ++outside;
      } else {
        cloud_.positions[kept++] = p;
        if (cloud_sights_) {
          cloud_.sights.push_back(sight_of(scan, i, p));
        }
        if (by_colour()) {
          cloud_.materials.push_back(material_of(scan, i));
        }
        if (keeps_colours_) {
          cloud_.colours.push_back(colour_of(scan, i));
        }
        if (normals) {
          cloud_.normals.push_back(usable_normal(scan.normals[i]));
        } else if (cloud_.has_normals()) {
          cloud_.normals.push_back(Eigen::Vector3f::Zero());
        }
      }
    }
    cloud_.positions.resize(kept);
    drop("non_finite", non_finite);
    drop("out_of_range", out_of_range);
    drop("outside_crop", outside);
  }

  [[nodiscard]] Eigen::Vector3f usable_normal(const Eigen::Vector3f& read) const {
    const Eigen::Vector3d normal = input_.frame.turn * read.cast<double>();
    const double length = normal.norm();
    if (!(length > 1e-30) || !(length < 1e30)) {
      return Eigen::Vector3f::Zero();
    }
    return (1.0 / length * normal).cast<float>();
  }

  void add_mesh(Scan&& scan) {
    const auto base = static_cast<std::uint32_t>(input_.mesh.positions.size());
    for (std::size_t i = 0; i < scan.positions.size(); ++i) {
      input_.mesh.positions.push_back(input_.frame.turned(scan.positions[i]));
      if (by_colour()) {
        input_.mesh.materials.push_back(material_of(scan, i));
      }
      if (keeps_colours_) {
        input_.mesh.colours.push_back(colour_of(scan, i));
      }
    }
    for (const auto& [i, j, k] : scan.triangles) {
      input_.mesh.triangles.push_back({base + i, base + j, base + k});
    }
  }

  // Some vertices that editing has left behind are usual; many may be a cloud beside the mesh.
  void leave_out_unused(std::size_t unused) {
    drop("not_in_a_face", unused);
    const std::size_t all = input_.mesh.positions.size();
    if (unused <= kMaxUnused ||
        static_cast<double>(unused) <= kMaxUnusedPart * static_cast<double>(all)) {
      return;
    }
    report_.warnings.push_back(
        fmt::format("{} of {} vertices of the mesh are in no face and were left out (if they are a "
                    "cloud of points beside it, export them to a file of their own and build from "
                    "both files)",
                    unused, all));
  }

  void clean_mesh() {
    Mesh& mesh = input_.mesh;
    if (mesh.triangles.empty()) {
      return;
    }
    std::vector<bool> used(mesh.positions.size(), false);
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) {
        used[corner] = true;
      }
    }
    leave_out_unused(static_cast<std::size_t>(std::count(used.begin(), used.end(), false)));
    const std::vector<bool> keep = corners_to_keep(used);
    const auto [degenerate, far] = drop_faces(mesh, keep);
    drop("degenerate_face", degenerate);
    drop("outlier_face", far);
    mesh_corners_ = static_cast<std::uint64_t>(std::count(keep.begin(), keep.end(), true));
    crop_mesh();
    drop_small_shells();
    for (const auto& [i, j, k] : mesh.triangles) {
      const std::array corners{mesh.positions[i], mesh.positions[j], mesh.positions[k]};
      if (options_.crop) {
        input_.bounds.extend(cropped_bounds(corners, input_.crop));
        continue;
      }
      for (const Eigen::Vector3d& corner : corners) {
        input_.bounds.extend(corner);
      }
    }
  }

  // Selects the vertices of faces that have a finite and plausible position.
  std::vector<bool> corners_to_keep(const std::vector<bool>& used) {
    const std::vector<Eigen::Vector3d>& positions = input_.mesh.positions;
    std::vector<Eigen::Vector3d> corners;
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i] && positions[i].allFinite() && is_in_range(positions[i])) {
        corners.push_back(positions[i]);
      }
    }
    const Box plausible = keep_outliers() ? Box() : plausible_box(corners, kMeshMargin);
    std::vector<bool> keep = used;
    std::uint64_t outliers = 0;
    std::uint64_t non_finite = 0;
    std::uint64_t out_of_range = 0;
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i] && !positions[i].allFinite()) {
        keep[i] = false;
        ++non_finite;
      } else if (used[i] && !is_in_range(positions[i])) {
        keep[i] = false;
        ++out_of_range;
      } else if (used[i] && !plausible.isEmpty() && !plausible.contains(positions[i])) {
        keep[i] = false;
        ++outliers;
      }
    }
    drop("non_finite", non_finite);
    drop("out_of_range", out_of_range);
    drop("outlier", outliers);
    return keep;
  }

  // Drops faces outside the crop box. Faces that cross its border stay and are sampled inside it
  // only.
  void crop_mesh() {
    if (!options_.crop) {
      return;
    }
    Mesh& mesh = input_.mesh;
    const std::size_t before = mesh.triangles.size();
    std::erase_if(mesh.triangles, [&](const std::array<std::uint32_t, 3>& triangle) {
      const auto& [i, j, k] = triangle;
      return cropped_bounds({mesh.positions[i], mesh.positions[j], mesh.positions[k]}, input_.crop)
          .isEmpty();
    });
    drop("face_outside_crop", before - mesh.triangles.size());
  }

  [[nodiscard]] PieceRule piece_rule() const { return {options_.keep_largest, options_.min_piece}; }
  [[nodiscard]] bool keep_all_pieces() const {
    return !options_.keep_largest && options_.min_piece == 0;
  }

  void drop_small_shells() {
    Mesh& mesh = input_.mesh;
    if (keep_all_pieces() || mesh.triangles.empty()) {
      return;
    }
    const std::vector<bool> keep = kept_corners(mesh, piece_rule());
    const auto corners = static_cast<std::uint64_t>(std::count(keep.begin(), keep.end(), false));
    drop("small_piece", corners);
    mesh_corners_ -= corners;
    drop("small_piece_face",
         std::erase_if(mesh.triangles, [&](const std::array<std::uint32_t, 3>& triangle) {
           return !keep[triangle[0]];
         }));
  }

  void drop_small_islands() {
    if (keep_all_pieces()) {
      return;
    }
    const std::vector<std::uint32_t> kept =
        kept_points(input_.points, kIslandSpacings * input_.points_spacing, piece_rule());
    drop("small_piece", input_.points.size() - kept.size());
    if (kept.size() < input_.points.size()) {
      input_.points.keep(kept);
      input_.points_spacing = estimate_spacing(input_.points).median_m;
    }
  }

  void clean_cloud() {
    if (cloud_.size() == 0) {
      return;
    }
    if (!keep_outliers()) {
      drop_far_points();
    }
    input_.points = ZOrderedCloud(std::move(cloud_));
    drop("duplicate", drop_duplicates(input_.points));
    input_.points_spacing = estimate_spacing(input_.points).median_m;
    if (!keep_outliers() && input_.points_spacing > 0.0) {
      const std::vector<std::uint32_t> kept =
          points_in_company(input_.points, input_.points_spacing);
      drop("outlier", input_.points.size() - kept.size());
      if (kept.size() < input_.points.size()) {
        input_.points.keep(kept);
      }
      drop_stray_points();
    }
    drop_small_islands();
    input_.bounds.extend(bounds_of(input_.points.positions()));
  }

  void drop_stray_points() {
    const SurfacePoints found =
        points_on_surfaces(input_.points, input_.points_spacing, options_.outlier_sigma);
    if (found.undecided) {
      report_.warnings.push_back(
          "more than an eighth of the points lie on no surface, so all points are kept (check the "
          "scan; the model is a surface through its points)");
    }
    drop("stray", input_.points.size() - found.kept.size());
    if (found.kept.size() < input_.points.size()) {
      input_.points.keep(found.kept);
      input_.points_spacing = estimate_spacing(input_.points).median_m;
    }
  }

  void drop_far_points() {
    const Box plausible = plausible_box(cloud_.positions, kCloudMargin);
    if (plausible.isEmpty()) {
      return;
    }
    std::vector<std::uint32_t> kept;
    kept.reserve(cloud_.size());
    for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
      if (plausible.contains(cloud_.positions[i])) {
        kept.push_back(i);
      }
    }
    if (kept.size() < cloud_.size()) {
      drop("outlier", cloud_.size() - kept.size());
      keep(cloud_, kept);
    }
  }

  [[nodiscard]] std::string nothing_left() const {
    std::string causes;
    for (const auto& [cause, count] : report_.dropped) {
      causes += fmt::format("{}{} {}", causes.empty() ? "" : ", ", count, cause);
    }
    return fmt::format("none of the {} points is usable; dropped: {} (check {})",
                       report_.input_points, causes.empty() ? "none" : causes,
                       report_.dropped.contains("out_of_range")  ? "--unit, --scale and the file"
                       : report_.dropped.contains("small_piece") ? "--min-piece"
                       : options_.crop                           ? "--crop and the file"
                                                                 : "the file");
  }

  // Coordinates that are all float32 numbers have steps that grow with the distance from the
  // origin.
  void note_float_steps(const Scan& scan) {
    double farthest = 0.0;
    Box box;
    for (const Eigen::Vector3d& p : scan.positions) {
      if (!is_float(p.x()) || !is_float(p.y()) || !is_float(p.z())) {
        return;
      }
      farthest = std::max(farthest, p.cwiseAbs().maxCoeff());
      box.extend(p);
    }
    if (farthest > kFarExtents * largest_edge(box)) {
      float_step_ = std::max(float_step_, std::ldexp(1.0, std::ilogb(farthest) - 23));
    }
  }

  void warn_of_float_steps() {
    const double step = float_step_ * input_.frame.source_scale();
    const double detail = input_.points_spacing > 0.0
                              ? input_.points_spacing
                              : largest_edge(input_.bounds) / kDetailsPerExtent;
    if (step > kMaxStepPerDetail * detail) {
      report_.warnings.push_back(fmt::format(
          "the coordinates are float32 numbers far from their origin: they have steps of {} "
          "(export the scan with double precision, or move it to its origin before the export)",
          length_text(step)));
    }
  }

  void place() {
    ModelFrame& frame = input_.frame;
    const double extent = largest_edge(input_.bounds);
    const double farthest =
        input_.bounds.min().cwiseAbs().cwiseMax(input_.bounds.max().cwiseAbs()).maxCoeff();
    const bool far = farthest > kFarExtents * extent;
    const bool fitted = options_.fit_m || options_.fit_edge_m;
    if (fitted || options_.centre || far) {
      frame.shift = input_.bounds.center();
    }
    if (fitted) {
      if (!(extent > 0.0)) {
        throw std::runtime_error(
            "--fit cannot scale the model: all its points coincide (use --scale)");
      }
      const double edge_m =
          options_.fit_m ? *options_.fit_m : options_.fit_edge_m(input_.bounds.sizes());
      frame.fit = edge_m / extent;
    } else if (far && !options_.centre) {
      const Eigen::Vector3d origin = frame.source_origin();
      report_.notes.push_back(
          fmt::format("the scan lies far from its origin; the origin of the model is moved to its "
                      "centre, ({:.12g}, {:.12g}, {:.12g}) in the source",
                      origin.x(), origin.y(), origin.z()));
    }
    frame.fit *= options_.placed_scale;
    require_size(frame.fit * extent);
    move_all();
    report_.source_scale = frame.source_scale();
    report_.source_origin =
        options_.pose ? frame.source_of(options_.pose->inverse() * Eigen::Vector3d::Zero())
                      : frame.source_origin();
  }

  static void require_size(double extent_m) {
    if (extent_m != 0.0 && !(extent_m >= kMinModel_m && extent_m <= kMaxModel_m)) {
      throw std::runtime_error(
          fmt::format("the model would be {} wide; the limits are 1 um and 1000 km (check --unit, "
                      "--scale and --fit)",
                      length_text(extent_m)));
    }
  }

  void move_all() {
    const ModelFrame& frame = input_.frame;
    if (frame.shift.isZero(0.0) && frame.fit == 1.0) {
      return;
    }
    const auto moved = [&](const Box& box, const Eigen::Vector3d& shift) {
      return box.isEmpty() ? box
                           : Box((frame.fit * (box.min() - shift)).eval(),
                                 (frame.fit * (box.max() - shift)).eval());
    };
    if (input_.points.size() > 0) {
      input_.points.transform(frame.shift, frame.fit);
    }
    for (Eigen::Vector3d& p : input_.mesh.positions) {
      p = frame.fit * (p - frame.shift);
    }
    input_.points_spacing *= frame.fit;
    input_.crop.box = moved(input_.crop.box, frame.turn.transpose() * frame.shift);
    input_.bounds = moved(input_.bounds, frame.shift);
  }

  const BuildOptions& options_;
  BuildReport& report_;
  CleanInput input_;
  Cloud cloud_;
  ColourCensus census_;
  double float_step_ = 0.0;    // step of float32 coordinates far from the origin, source units
  bool cloud_sights_ = false;  // some points were seen from a known position
  bool keeps_colours_ = false;
  std::uint64_t mesh_corners_ = 0;
};

}  // namespace

CleanInput clean(std::vector<Scan> scans, const BuildOptions& options, BuildReport& report) {
  return Cleaner(options, report).run(std::move(scans));
}

}  // namespace tactree::builder
