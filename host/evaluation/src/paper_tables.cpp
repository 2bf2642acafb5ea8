#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "measurements.hpp"
#include "tactree/core/contact/paper_mode.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/core/model/nearest.hpp"
#include "tactree/core/model/octree.hpp"
#include "touch.hpp"

namespace tactree::evaluation {
namespace {

using Eigen::Vector3d;

constexpr int kProbes = 6820;
constexpr double kHalf = 0.25;        // m, half width of the domain
constexpr double kMargin = 5e-6;      // m, the paper's allowance for the resolution of a device
constexpr double kOnSurface = 0.235;  // fraction of the probes on the surface when hovering
constexpr double kFinest = 0.0025;    // m, the paper's finest spacing, box and offset

// Mean of the minimum and maximum height, m. Subtracting it moves the sheet to the origin, which
// reduces float32 rounding.
constexpr double kOffset = 1.9689;

CosSheet paper_sheet() { return {1.0, 1.0}; }

Vector3d on_sheet(double x, double y) {
  return paper_sheet().point(x, y) - Vector3d(0.0, 0.0, kOffset);
}

/// Blob of the sheet with this spacing of the points. In paper mode, box and offset are 2.5 mm for
/// any spacing.
Shape sheet_blob(double separation_m, core::Profile profile) {
  Shape shape(profile == core::Profile::kPaper ? kFinest : separation_m);
  const int n = static_cast<int>(std::lround(kHalf / separation_m));
  for (int i = -n; i <= n; ++i) {
    for (int j = -n; j <= n; ++j) {
      const double x = i * separation_m;
      const double y = j * separation_m;
      shape.add(on_sheet(x, y), paper_sheet().normal(x, y));
    }
  }
  shape.model().profile = profile;
  shape.seal();
  return shape;
}

/// Resolution of a surface blob: the paper's margin plus one step of the lattice.
double resolution_of(const core::BlobView& view) {
  return kMargin + static_cast<double>(view.header().leaf_edge_min_m) / 1024.0;
}

bool in_contact(const core::BlobView& view, Mode mode, const Vector3d& probe) {
  if (mode == kPaper) {
    return core::paper_collision(view, narrow(probe)).in_contact;
  }
  const core::SurfaceProjection p = core::project_to_surface(view, narrow(probe));
  return p.supported && std::abs(static_cast<double>(p.signed_distance)) <= resolution_of(view);
}

/// A rigid pose that changes from probe to probe, stored in float32.
class Pose {
 public:
  explicit Pose(int probe) {
    const double t = 1e-3 * probe;
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.7 * t, Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
    turn_ = turn.cast<float>();
    shift_ = Vector3d(0.05 * std::sin(t), 0.04 * std::cos(t), 0.01 * t).cast<float>();
  }
  /// To the world frame and back to the model frame, as in a controller.
  [[nodiscard]] Vector3d there_and_back(const Vector3d& p) const {
    const Eigen::Vector3f world = turn_ * p.cast<float>() + shift_;
    return (turn_.transpose() * (world - shift_)).cast<double>();
  }

 private:
  Eigen::Matrix3f turn_;
  Eigen::Vector3f shift_;
};

/// Counts the errors of contact detection with the fraction `share` of the probes on the surface
/// and the others 2 to 10 mm above it.
DetectionRow::Count count_errors(const core::BlobView& view, Mode mode, double share, bool dynamic,
                                 std::uint32_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-kHalf, kHalf);
  std::uniform_real_distribution<double> height(0.002, 0.010);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  DetectionRow::Count count;
  for (int i = 0; i < kProbes; ++i) {
    const double x = place(random);
    const double y = place(random);
    const bool touching = chance(random) < share;
    const double above = touching ? 0.0 : height(random);
    Vector3d probe = on_sheet(x, y) + above * paper_sheet().normal(x, y);
    probe = dynamic ? Pose(i).there_and_back(probe) : probe;
    const bool found = in_contact(view, mode, probe);
    ++count.probes;
    count.false_positives += found && !touching ? 1 : 0;
    count.false_negatives += !found && touching ? 1 : 0;
  }
  return count;
}

/// The leaves that the paper searches if the octant of the detection is remembered: that octant,
/// and those of the six offset points.
std::vector<core::Leaf> remembered_leaves(const core::BlobView& view, const Vector3d& spot) {
  std::vector<core::Leaf> leaves;
  const core::PaperContact contact = core::paper_collision(view, narrow(spot));
  if (!contact.in_contact) {
    return leaves;
  }
  leaves.push_back(contact.leaf);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double s : {-kFinest, kFinest}) {
      core::Leaf leaf;
      if (core::find_leaf(view, narrow(spot + s * Vector3d::Unit(axis)), leaf)) {
        leaves.push_back(leaf);
      }
    }
  }
  return leaves;
}

double nearest_in(const core::BlobView& view, const std::vector<core::Leaf>& leaves,
                  const Vector3d& probe) {
  double best = 1e30;
  for (const core::Leaf& leaf : leaves) {
    for (std::uint32_t i = 0; i < leaf.point_count; ++i) {
      const Vector3d point = widen(view.position(leaf, leaf.first_point + i));
      best = std::min(best, (point - probe).squaredNorm());
    }
  }
  return std::sqrt(best);
}

/// True if a leaf contains the probe or one of its six offset points.
bool any_leaf(const core::BlobView& view, const Vector3d& probe) {
  core::Leaf leaf;
  if (core::find_leaf(view, narrow(probe), leaf)) {
    return true;
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const double s : {-kFinest, kFinest}) {
      if (core::find_leaf(view, narrow(probe + s * Vector3d::Unit(axis)), leaf)) {
        return true;
      }
    }
  }
  return false;
}

struct Crisscross {
  double x = 0.0;
  double y = 0.0;
  double above = 0.0;
  [[nodiscard]] Vector3d probe() const { return on_sheet(x, y) + Vector3d(0.0, 0.0, above); }
};

Crisscross draw(std::mt19937_64& random, double half_m) {
  std::uniform_real_distribution<double> place(-half_m, half_m);
  Crisscross c;
  c.x = place(random);
  c.y = place(random);
  c.above = std::uniform_real_distribution<double>(-0.05, 0.01)(random);
  return c;
}

double brute_force(const std::vector<Vector3d>& points, const Vector3d& probe) {
  double best = 1e30;
  for (const Vector3d& point : points) {
    best = std::min(best, (point - probe).squaredNorm());
  }
  return std::sqrt(best);
}

std::vector<Vector3d> points_of(const core::BlobView& view) {
  std::vector<Vector3d> points;
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    points.push_back(widen(view.position(leaf, index)));
  });
  return points;
}

// Half width of the flat top, m, where the octant of the detection is the nearest at any depth.
constexpr double kTop = 0.075;

void paper_distances(int probes, std::mt19937_64 random, DistanceTable& table) {
  const Shape shape = sheet_blob(kFinest, core::Profile::kPaper);
  const core::BlobView& view = shape.view();
  const std::vector<Vector3d> points = points_of(view);
  int without = 0;
  double sum = 0.0;
  int measured = 0;
  for (int i = 0; i < probes; ++i) {
    without += any_leaf(view, draw(random, kHalf).probe()) ? 0 : 1;
    const Crisscross c = draw(random, kTop);
    const std::vector<core::Leaf> leaves = remembered_leaves(view, on_sheet(c.x, c.y));
    if (leaves.empty()) {
      continue;
    }
    const double excess = nearest_in(view, leaves, c.probe()) - brute_force(points, c.probe());
    sum += excess;
    table.paper_max_m = std::max(table.paper_max_m, excess);
    ++measured;
  }
  table.literal_without_point = static_cast<double>(without) / probes;
  table.paper_mean_m = sum / measured;
}

/// Lowers the probe to its position and compares the distance of the proxy with the true distance.
double proxy_error(const core::BlobView& view, const Crisscross& c) {
  const Vector3d probe = c.probe();
  const Vector3d foot =
      paper_sheet().nearest(probe + Vector3d(0.0, 0.0, kOffset)) - Vector3d(0.0, 0.0, kOffset);
  const Vector3d normal = paper_sheet().normal(foot.x(), foot.y());
  const double truth = (probe - foot).norm();
  if ((probe - foot).dot(normal) >= 0.0) {
    const core::SurfaceProjection p = core::project_to_surface(view, narrow(probe));
    return p.supported ? static_cast<double>(p.signed_distance) - truth : 0.0;
  }
  constexpr double kStep = 1e-3;
  const Vector3d begin = probe + (truth + 0.005) * Vector3d::UnitZ();
  Touch touch(view, core::RenderMode::kSurface, begin);
  Touched touched;
  for (double z = begin.z(); z > probe.z(); z -= kStep) {
    touched = touch.to({probe.x(), probe.y(), z});
  }
  for (int i = 0; i < 20; ++i) {  // the proxy slips to the nearest point
    touched = touch.to(probe);
  }
  return (touched.proxy - probe).norm() - truth;
}

void surface_distances(int probes, std::mt19937_64 random, DistanceTable& table) {
  const Shape shape = sheet_blob(kFinest, core::Profile::kSurface);
  const core::BlobView& view = shape.view();
  const std::vector<Vector3d> points = points_of(view);
  double sum = 0.0;
  for (int i = 0; i < probes; ++i) {
    Crisscross c = draw(random, kTop);
    const double error = std::abs(proxy_error(view, c));
    sum += error;
    table.surface_max_m = std::max(table.surface_max_m, error);
    const core::NearestPoint found = core::nearest_within(view, narrow(c.probe()), view.reach_m());
    if (found.found()) {
      const double excess = std::sqrt(static_cast<double>(found.distance_squared)) -
                            brute_force(points, widen(narrow(c.probe())));
      table.nearest_max_m = std::max(table.nearest_max_m, std::abs(excess));
    }
  }
  table.surface_mean_m = sum / probes;
}

}  // namespace

std::vector<DetectionRow> measure_detection(std::uint32_t seed) {
  std::vector<DetectionRow> rows = {
      {0.01, false, 0.77889, 100, 1408, {}, {}}, {0.005, false, 0.89633, 291, 416, {}, {}},
      {0.0025, false, 0.98431, 1, 106, {}, {}},  {0.0025, true, 0.9818, 3, 179, {}, {}},
      {0.01, true, 0.0, 0, 0, {}, {}},           {0.005, true, 0.0, 0, 0, {}, {}}};
  for (DetectionRow& row : rows) {
    const Shape surface = sheet_blob(row.separation_m, core::Profile::kSurface);
    const Shape paper = sheet_blob(row.separation_m, core::Profile::kPaper);
    for (const Mode mode : {kSurface, kPaper}) {
      const core::BlobView& view = mode == kPaper ? paper.view() : surface.view();
      row.tracing[mode] = count_errors(view, mode, 1.0, row.dynamic, seed);
      row.hovering[mode] = count_errors(view, mode, kOnSurface, row.dynamic, seed);
    }
  }
  return rows;
}

DistanceTable measure_distances(std::uint32_t seed, int probes) {
  DistanceTable table;
  const std::mt19937_64 random(seed);
  paper_distances(probes, random, table);
  surface_distances(probes, random, table);
  return table;
}

}  // namespace tactree::evaluation
