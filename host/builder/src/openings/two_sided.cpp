#include "openings/two_sided.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "openings/gaps.hpp"

namespace tactree::builder {
namespace {

class Thickener {
 public:
  Thickener(const ZOrderedCloud& sheet, double spacing, double thickness)
      : sheet_(sheet), half_(0.5 * thickness) {
    const double arc = std::numbers::pi * half_;
    steps_ = std::max(2, static_cast<int>(std::lround(arc / spacing)));
  }

  void add_sides(std::uint32_t i) {
    add(i, sheet_.normals()[i].cast<double>());
    add(i, -sheet_.normals()[i].cast<double>());
  }

  // Adds half a circle of points from one side to the other, around the edge of the sheet.
  void add_edge(std::uint32_t i, const Eigen::Vector3f& away) {
    const Eigen::Vector3d normal = sheet_.normals()[i].cast<double>();
    Eigen::Vector3d outward = away.cast<double>();
    outward -= outward.dot(normal) * normal;
    if (!(outward.norm() > 0.1)) {
      return;
    }
    outward.normalize();
    for (int step = 1; step < steps_; ++step) {
      const double angle = std::numbers::pi * (static_cast<double>(step) / steps_ - 0.5);
      add(i, std::cos(angle) * outward + std::sin(angle) * normal);
      ++at_edge_;
    }
  }

  Thickened finish() { return {ZOrderedCloud(std::move(cloud_)), at_edge_}; }

 private:
  void add(std::uint32_t i, const Eigen::Vector3d& direction) {
    cloud_.positions.push_back(sheet_.positions()[i] + half_ * direction);
    cloud_.normals.push_back(direction.cast<float>());
    if (sheet_.cloud().has_materials()) {
      cloud_.materials.push_back(sheet_.cloud().materials[i]);
    }
    if (sheet_.cloud().has_colours()) {
      cloud_.colours.push_back(sheet_.cloud().colours[i]);
    }
  }

  const ZOrderedCloud& sheet_;
  double half_;
  int steps_ = 2;
  Cloud cloud_;
  std::uint64_t at_edge_ = 0;
};

}  // namespace

Thickened thicken(const ZOrderedCloud& sheet, double spacing, double radius, double thickness) {
  const std::vector<Eigen::Vector3f> away = border_directions(sheet, spacing, radius);
  Thickener thickener(sheet, spacing, thickness);
  for (std::uint32_t i = 0; i < sheet.size(); ++i) {
    thickener.add_sides(i);
    if (!away[i].isZero()) {
      thickener.add_edge(i, away[i]);
    }
  }
  return thickener.finish();
}

}  // namespace tactree::builder
