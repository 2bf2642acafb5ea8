#include "relief.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tactree/plant/vectors.hpp"

namespace tactree::simulation {
namespace {

using plant::widen;

constexpr double kFacing = 0.2;       // minimum cosine of the normal of a point that is visible
constexpr double kMaxCells = 1024.0;  // per side

template <class Use>
void for_each_surface_point(const core::BlobView& view, const Use& use) {
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    const core::SurfacePoint point = view.surface_point(leaf, index);
    use(widen(point.position), widen(point.normal));
  });
}

}  // namespace

Relief::Relief(const core::BlobView& view) {
  if (view.empty()) {
    throw std::invalid_argument("the model is empty");
  }
  choose_view(view);
  low_.setConstant(std::numeric_limits<double>::infinity());
  high_.setConstant(-std::numeric_limits<double>::infinity());
  for_each_surface_point(view, [this](const Eigen::Vector3d& position, const Eigen::Vector3d&) {
    const Eigen::Vector3d uvw = to_relief(position);
    low_ = low_.cwiseMin(uvw);
    high_ = high_.cwiseMax(uvw);
  });
  fill(view);
  find_middle();
}

void Relief::choose_view(const core::BlobView& view) {
  std::array<double, 6> facing{};  // -x -y -z +x +y +z
  for_each_surface_point(view, [&facing](const Eigen::Vector3d&, const Eigen::Vector3d& normal) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double component = normal[static_cast<Eigen::Index>(axis)];
      facing[axis] += std::max(0.0, -component);
      facing[axis + 3] += std::max(0.0, component);
    }
  });
  // Models usually stand upright, therefore the view from above is preferred unless another side
  // shows clearly more surface.
  facing[5] *= 1.2;
  const auto best = std::max_element(facing.begin(), facing.end()) - facing.begin();
  axis_ = best % 3;
  sign_ = best < 3 ? -1.0 : 1.0;
}

Eigen::Vector3d Relief::to_relief(const Eigen::Vector3d& xyz) const {
  return {xyz[(axis_ + 1) % 3], xyz[(axis_ + 2) % 3], sign_ * xyz[axis_]};
}

Eigen::Vector3d Relief::to_model(const Eigen::Vector3d& uvw) const {
  Eigen::Vector3d xyz;
  xyz[(axis_ + 1) % 3] = uvw.x();
  xyz[(axis_ + 2) % 3] = uvw.y();
  xyz[axis_] = sign_ * uvw.z();
  return xyz;
}

std::ptrdiff_t Relief::column(double u) const {
  return static_cast<std::ptrdiff_t>(std::floor((u - low_.x()) / cell_m_));
}

std::ptrdiff_t Relief::row(double v) const {
  return static_cast<std::ptrdiff_t>(std::floor((v - low_.y()) / cell_m_));
}

void Relief::fill(const core::BlobView& view) {
  const double extent = std::max(high_.x() - low_.x(), high_.y() - low_.y());
  const double spacing = static_cast<double>(view.header().spacing_m);
  cell_m_ = std::max({2.0 * spacing, extent / kMaxCells, 1e-9});
  columns_ = column(high_.x()) + 1;
  rows_ = row(high_.y()) + 1;
  heights_.assign(static_cast<std::size_t>(columns_ * rows_),
                  std::numeric_limits<double>::quiet_NaN());
  for_each_surface_point(view, [this](const Eigen::Vector3d& position,
                                      const Eigen::Vector3d& normal) {
    if (sign_ * normal[axis_] < kFacing) {
      return;
    }
    const Eigen::Vector3d uvw = to_relief(position);
    double& cell = heights_[static_cast<std::size_t>(row(uvw.y()) * columns_ + column(uvw.x()))];
    cell = std::isnan(cell) ? uvw.z() : std::max(cell, uvw.z());
  });
}

double Relief::cell(std::ptrdiff_t column, std::ptrdiff_t row) const {
  const bool inside = row >= 0 && row < rows_ && column >= 0 && column < columns_;
  return inside ? heights_[static_cast<std::size_t>(row * columns_ + column)]
                : std::numeric_limits<double>::quiet_NaN();
}

bool Relief::height(double u, double v, double& w) const {
  const std::ptrdiff_t c = column(u);
  const std::ptrdiff_t r = row(v);
  double best = cell(c, r);
  if (std::isnan(best)) {
    for (std::ptrdiff_t i = 0; i < 9; ++i) {
      const double beside = cell(c - 1 + i % 3, r - 1 + i / 3);
      best = std::isnan(best) || beside > best ? beside : best;
    }
  }
  if (std::isnan(best)) {
    return false;
  }
  w = best;
  return true;
}

void Relief::find_middle() {
  const Eigen::Vector2d centre = 0.5 * (low_ + high_).head<2>();
  double best = std::numeric_limits<double>::infinity();
  middle_ = centre;
  for (std::ptrdiff_t r = 0; r < rows_; ++r) {
    for (std::ptrdiff_t c = 0; c < columns_; ++c) {
      const Eigen::Vector2d place(low_.x() + (static_cast<double>(c) + 0.5) * cell_m_,
                                  low_.y() + (static_cast<double>(r) + 0.5) * cell_m_);
      const bool surface = !std::isnan(heights_[static_cast<std::size_t>(r * columns_ + c)]);
      const double distance = (place - centre).squaredNorm();
      if (surface && distance < best) {
        best = distance;
        middle_ = place;
      }
    }
  }
}

}  // namespace tactree::simulation
