#include "range_image.hpp"

#include <Eigen/Geometry>
#include <limits>

namespace tactree::builder {
namespace {

constexpr double kClearMajority = 0.97;  // of the triangles; lens distortion reverses a few
constexpr std::uint64_t kMaxWidth = std::uint64_t{1} << 20;

}  // namespace

RangeImage::RangeImage(std::uint64_t width, const std::optional<Eigen::Vector3d>& stated,
                       bool certain)
    : width_(width <= kMaxWidth ? static_cast<std::size_t>(width) : 0),
      stated_(stated.has_value()),
      certain_(certain) {
  as_stated_.position = stated.value_or(Eigen::Vector3d::Zero());
  last_row_.assign(width_,
                   Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()).eval());
}

void RangeImage::add(const Eigen::Vector3d& position) {
  if (width_ == 0) return;
  const Eigen::Vector3d above = last_row_[column_];
  if (column_ > 0) {
    const Eigen::Vector3d facing = (position - left_).cross(position - above);
    for (Candidate* candidate : {&as_stated_, &at_origin_}) {
      const double side = facing.dot(position - candidate->position);  // NaN: no triangle
      candidate->right += side > 0.0 ? 1U : 0U;
      candidate->mirrored += side < 0.0 ? 1U : 0U;
    }
  }
  left_ = position;
  last_row_[column_] = position;
  column_ = column_ + 1 == width_ ? 0 : column_ + 1;
}

bool RangeImage::most(std::uint64_t votes, const Candidate& of) {
  return votes > 0 &&
         static_cast<double>(votes) >= kClearMajority * static_cast<double>(of.right + of.mirrored);
}

std::optional<ScannerPose> RangeImage::pose() const {
  const bool elsewhere = !as_stated_.position.isZero(0.0);
  if (width_ == 0) {
    return stated_ ? std::optional(ScannerPose{as_stated_.position, 0, elsewhere}) : std::nullopt;
  }
  if (most(as_stated_.right, as_stated_)) return ScannerPose{as_stated_.position, 0, true};
  if (!certain_ && most(at_origin_.right, at_origin_)) {
    return ScannerPose{at_origin_.position, 0, true};
  }
  if ((elsewhere || certain_) && most(as_stated_.mirrored, as_stated_)) {
    return ScannerPose{as_stated_.position, 0, true};
  }
  return std::nullopt;
}

}  // namespace tactree::builder
