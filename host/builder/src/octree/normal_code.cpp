#include "octree/normal_code.hpp"

#include <algorithm>
#include <cmath>

namespace tactree::builder {

Eigen::Vector3d decode_normal(std::uint32_t code) {
  const double u = static_cast<double>(code & 511U) - 255.0;
  const double v = static_cast<double>(code >> 9) - 255.0;
  const double w = 255.0 - std::abs(u) - std::abs(v);
  Eigen::Vector3d n(u, v, w);
  if (w < 0.0) {
    n.x() += u < 0.0 ? -w : w;
    n.y() += v < 0.0 ? -w : w;
  }
  return n.normalized();
}

std::uint32_t encode_normal(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d n = normal / normal.lpNorm<1>();
  double u = n.x();
  double v = n.y();
  if (n.z() < 0.0) {
    u = (1.0 - std::abs(n.y())) * (n.x() < 0.0 ? -1.0 : 1.0);
    v = (1.0 - std::abs(n.x())) * (n.y() < 0.0 ? -1.0 : 1.0);
  }
  // The nearest u and v do not always give the nearest direction, so the four codes around are
  // tried.
  const double fu = std::floor(u * 255.0);
  const double fv = std::floor(v * 255.0);
  std::uint32_t best = 0;
  double best_dot = -2.0;
  for (int corner = 0; corner < 4; ++corner) {
    const auto cu =
        static_cast<std::uint32_t>(std::clamp(fu + (corner & 1), -255.0, 255.0) + 255.0);
    const auto cv =
        static_cast<std::uint32_t>(std::clamp(fv + (corner >> 1), -255.0, 255.0) + 255.0);
    const std::uint32_t code = cu | cv << 9;
    const double alignment = decode_normal(code).dot(normal);
    if (alignment > best_dot) {
      best_dot = alignment;
      best = code;
    }
  }
  return best;
}

}  // namespace tactree::builder
