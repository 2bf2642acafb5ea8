#include "las_box.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace tactree::builder {
namespace {

// In sizes of the box. Some programs round the box, or take it before they round the coordinates.
constexpr double kRounding = 0.05;
constexpr double kFar = 10.0;
// A record that is read from a wrong byte has coordinates anywhere in the range of 32 bits. A file
// whose points fill half of this range and lie in their box uses its range well.
constexpr double kHalfRange = 2147483648.0;
constexpr std::uint64_t kLeastDamaged = 10;  // of as many points, one

std::string text_of(const Eigen::Vector3d& least, const Eigen::Vector3d& most) {
  const Eigen::Vector3d size = most - least;
  return fmt::format("{:.4g} x {:.4g} x {:.4g}", size.x(), size.y(), size.z());
}

}  // namespace

LasBoxCheck::LasBoxCheck(const LasBox& box, const Eigen::Vector3d& scale)
    : box_(box),
      scale_(scale.cwiseAbs()),
      least_(Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity())),
      most_(-least_) {
  const Eigen::Vector3d size = box.most - box.least;
  if (size.allFinite() && size.minCoeff() >= 0.0) size_ = size.maxCoeff();
}

void LasBoxCheck::add(const Eigen::Vector3d& position) {
  if (size_ == 0.0 || !position.allFinite()) return;
  ++points_;
  least_ = least_.cwiseMin(position);
  most_ = most_.cwiseMax(position);
  const Eigen::Vector3d beyond =
      (box_.least - position).cwiseMax(position - box_.most) - 2.0 * scale_;
  const double distance = beyond.maxCoeff();
  if (distance > kRounding * size_) ++outside_;
  if (distance > kFar * size_) ++far_outside_;
}

bool LasBoxCheck::are_damaged() const {
  const bool fills_range = ((most_ - least_).array() > kHalfRange * scale_.array()).any();
  return fills_range && far_outside_ > points_ / kLeastDamaged;
}

std::string LasBoxCheck::message() const {
  if (outside_ == 0) return "";
  return fmt::format(
      "{} of {} points lie outside of the box that the header states: it has a size of {}, the "
      "points of {} in the unit of the file",
      outside_, points_, text_of(box_.least, box_.most), text_of(least_, most_));
}

}  // namespace tactree::builder
