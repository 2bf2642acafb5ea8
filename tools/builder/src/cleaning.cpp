#include "cleaning.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

#include "outliers.hpp"
#include "spacing.hpp"

namespace tactree::builder {
namespace {

// A cloud's strays are looked for beyond 10 times its bulk's size, a mesh's corners beyond 100: a
// detailed figure may stand on a large, coarse plinth.
constexpr double kCloudMargin = 10.0;
constexpr double kMeshMargin = 100.0;
// Farther than this from the origin, in extents, float32 would lose what matters.
constexpr double kFarExtents = 4.0;

Eigen::Matrix3d turn_up(UpAxis up) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (up == UpAxis::kY) {
    turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // y -> z, z -> -y
  } else if (up == UpAxis::kX) {
    turn << 0, 1, 0, 0, 0, 1, 1, 0, 0;  // x -> z, y -> x, z -> y
  }
  return turn;
}

class Cleaner {
 public:
  Cleaner(const BuildOptions& options, BuildReport& report) : options_(options), report_(report) {
    input_.frame.turn = turn_up(options.up);
    input_.frame.unit = options.unit_m * options.scale;
    if (options.crop) {
      for (int corner = 0; corner < 8; ++corner) {
        input_.crop.extend(input_.frame.turned(
            options.crop->corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
      }
    }
  }

  CleanInput run(std::vector<Scan> scans) {
    require_colours(scans);
    for (Scan& scan : scans) {
      count_input(scan);
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
    return std::move(input_);
  }

 private:
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
  }

  [[nodiscard]] bool by_colour() const {
    return options_.materials && options_.materials->by_colour();
  }

  void require_colours(const std::vector<Scan>& scans) const {
    const bool coloured = std::any_of(scans.begin(), scans.end(),
                                      [](const Scan& scan) { return !scan.colours.empty(); });
    if (by_colour() && !coloured) {
      throw std::runtime_error(
          "the materials go by colour, and no input has colours at its points (export the scan "
          "with vertex colours, or give one material for the whole model)");
    }
  }

  /// What a scan without colours holds is of the base material.
  [[nodiscard]] std::uint8_t material_of(const Scan& scan, std::size_t point) const {
    return scan.colours.empty() ? std::uint8_t{0}
                                : options_.materials->index_of(scan.colours[point]);
  }

  void add_cloud(Scan&& scan) {
    const bool normals = scan.normals.size() == scan.positions.size();
    std::uint64_t non_finite = 0;
    std::uint64_t outside = 0;
    cloud_.positions.reserve(cloud_.size() + scan.positions.size());
    if (normals || cloud_.has_normals()) {
      cloud_.normals.resize(cloud_.size(), Eigen::Vector3f::Zero());
      cloud_.normals.reserve(cloud_.positions.capacity());
    }
    for (std::size_t i = 0; i < scan.positions.size(); ++i) {
      const Eigen::Vector3d p = input_.frame.turned(scan.positions[i]);
      if (!p.allFinite()) {
        ++non_finite;
      } else if (options_.crop && !options_.crop->contains(scan.positions[i])) {
        ++outside;
      } else {
        cloud_.positions.push_back(p);
        if (by_colour()) {
          cloud_.materials.push_back(material_of(scan, i));
        }
        if (normals) {
          cloud_.normals.push_back(usable_normal(scan.normals[i]));
        } else if (cloud_.has_normals()) {
          cloud_.normals.push_back(Eigen::Vector3f::Zero());
        }
      }
    }
    drop("non_finite", non_finite);
    drop("outside_crop", outside);
  }

  [[nodiscard]] Eigen::Vector3f usable_normal(const Eigen::Vector3f& read) const {
    const Eigen::Vector3d normal = input_.frame.turn * read.cast<double>();
    const double length = normal.norm();
    if (!(length > 1e-30) || !(length < 1e30)) {
      return Eigen::Vector3f::Zero();
    }
    return ((options_.flip_normals ? -1.0 : 1.0) / length * normal).cast<float>();
  }

  void add_mesh(Scan&& scan) {
    const auto base = static_cast<std::uint32_t>(input_.mesh.positions.size());
    for (std::size_t i = 0; i < scan.positions.size(); ++i) {
      input_.mesh.positions.push_back(input_.frame.turned(scan.positions[i]));
      if (by_colour()) {
        input_.mesh.materials.push_back(material_of(scan, i));
      }
    }
    for (auto [i, j, k] : scan.triangles) {
      if (options_.flip_normals) {
        std::swap(j, k);
      }
      input_.mesh.triangles.push_back({base + i, base + j, base + k});
    }
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
    drop("not_in_a_face", static_cast<std::uint64_t>(std::count(used.begin(), used.end(), false)));
    const std::vector<bool> keep = corners_to_keep(used);
    const auto [degenerate, far] = drop_faces(mesh, keep);
    drop("degenerate_face", degenerate);
    drop("outlier_face", far);
    mesh_corners_ = static_cast<std::uint64_t>(std::count(keep.begin(), keep.end(), true));
    crop_mesh();
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) {
        input_.bounds.extend(mesh.positions[corner]);
      }
    }
    if (options_.crop && !mesh.triangles.empty()) {
      input_.bounds = input_.bounds.intersection(input_.crop);
    }
  }

  // Of the corners that a face names, those at a finite and plausible place.
  std::vector<bool> corners_to_keep(const std::vector<bool>& used) {
    const std::vector<Eigen::Vector3d>& positions = input_.mesh.positions;
    std::vector<Eigen::Vector3d> corners;
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i] && positions[i].allFinite()) {
        corners.push_back(positions[i]);
      }
    }
    const Box plausible = options_.keep_outliers ? Box() : plausible_box(corners, kMeshMargin);
    std::vector<bool> keep = used;
    std::uint64_t outliers = 0;
    std::uint64_t non_finite = 0;
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i] && !positions[i].allFinite()) {
        keep[i] = false;
        ++non_finite;
      } else if (used[i] && !plausible.isEmpty() && !plausible.contains(positions[i])) {
        keep[i] = false;
        ++outliers;
      }
    }
    drop("non_finite", non_finite);
    drop("outlier", outliers);
    return keep;
  }

  // Faces clear of the crop go; of the others the part outside is not sampled.
  void crop_mesh() {
    if (!options_.crop) {
      return;
    }
    Mesh& mesh = input_.mesh;
    const std::size_t before = mesh.triangles.size();
    std::erase_if(mesh.triangles, [&](const std::array<std::uint32_t, 3>& triangle) {
      Box box;
      for (const std::uint32_t corner : triangle) {
        box.extend(mesh.positions[corner]);
      }
      return !input_.crop.intersects(box);
    });
    drop("face_outside_crop", before - mesh.triangles.size());
  }

  void clean_cloud() {
    if (cloud_.size() == 0) {
      return;
    }
    if (!options_.keep_outliers) {
      drop_far_points();
    }
    input_.points = ZOrderedCloud(std::move(cloud_));
    drop("duplicate", drop_duplicates(input_.points));
    input_.points_spacing = estimate_spacing(input_.points).median_m;
    if (!options_.keep_outliers && input_.points_spacing > 0.0) {
      const std::vector<std::uint32_t> kept =
          points_in_company(input_.points, input_.points_spacing);
      drop("outlier", input_.points.size() - kept.size());
      if (kept.size() < input_.points.size()) {
        input_.points = input_.points.subset(kept);
      }
    }
    input_.bounds.extend(bounds_of(input_.points.positions()));
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
      cloud_ = select(cloud_, kept);
    }
  }

  [[nodiscard]] std::string nothing_left() const {
    std::string causes;
    for (const auto& [cause, count] : report_.dropped) {
      causes += fmt::format("{}{} {}", causes.empty() ? "" : ", ", count, cause);
    }
    return fmt::format("nothing to touch is left of {} points; dropped: {} (look at {})",
                       report_.input_points, causes.empty() ? "none" : causes,
                       options_.crop ? "--crop and the file" : "the file");
  }

  void place() {
    Frame& frame = input_.frame;
    const double extent = largest_edge(input_.bounds);
    const double farthest =
        input_.bounds.min().cwiseAbs().cwiseMax(input_.bounds.max().cwiseAbs()).maxCoeff();
    const bool far = farthest > kFarExtents * extent;
    if (options_.fit_m || options_.centre || far) {
      frame.shift = input_.bounds.center();
    }
    if (options_.fit_m) {
      if (!(extent > 0.0)) {
        throw std::runtime_error("all points are at one place: --fit has nothing to scale");
      }
      frame.fit = *options_.fit_m / extent;
    } else if (far && !options_.centre) {
      const Eigen::Vector3d origin = frame.source_origin();
      report_.notes.push_back(
          fmt::format("the scan lies far from its origin: the model's origin is its middle, "
                      "({:.12g}, {:.12g}, {:.12g}) in the source",
                      origin.x(), origin.y(), origin.z()));
    }
    move_all();
    report_.source_scale = frame.source_scale();
    report_.source_origin = frame.source_origin();
  }

  void move_all() {
    const Frame& frame = input_.frame;
    if (frame.shift.isZero(0.0) && frame.fit == 1.0) {
      return;
    }
    const auto moved = [&](const Box& box) {
      return box.isEmpty() ? box
                           : Box((frame.fit * (box.min() - frame.shift)).eval(),
                                 (frame.fit * (box.max() - frame.shift)).eval());
    };
    if (input_.points.size() > 0) {
      input_.points.transform(frame.shift, frame.fit);
    }
    for (Eigen::Vector3d& p : input_.mesh.positions) {
      p = frame.fit * (p - frame.shift);
    }
    input_.points_spacing *= frame.fit;
    input_.crop = moved(input_.crop);
    input_.bounds = moved(input_.bounds);
  }

  const BuildOptions& options_;
  BuildReport& report_;
  CleanInput input_;
  Cloud cloud_;
  std::uint64_t mesh_corners_ = 0;
};

}  // namespace

CleanInput clean(std::vector<Scan> scans, const BuildOptions& options, BuildReport& report) {
  return Cleaner(options, report).run(std::move(scans));
}

}  // namespace tactree::builder
