#pragma once
// Hands that follow a path over the edges of exact bodies, and the scores of their contact.

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "tactree/core/model/blob.hpp"
#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

struct Pace {
  double rate_hz;
  double speed_m_s;
};
inline constexpr Pace kPaces[] = {
    {1000.0, 0.02}, {1000.0, 0.1}, {2000.0, 0.1}, {4000.0, 0.1}, {4000.0, 0.5}};

/// A quick evaluation omits the slow pace, which takes a third of the ticks.
inline std::span<const Pace> paces(bool quick) { return std::span(kPaces).subspan(quick ? 1 : 0); }

/// Positions of a hand, one per tick, m.
class EdgePath {
 public:
  EdgePath(const Eigen::Vector3d& begin, const Pace& pace) : pace_(pace), places_{begin} {}

  /// On a straight line.
  void move_to(const Eigen::Vector3d& end);
  /// Rests for the time after which the proxy must be on the crease.
  void stay();

  [[nodiscard]] const Pace& pace() const { return pace_; }
  [[nodiscard]] std::span<const Eigen::Vector3d> places() const { return places_; }

 private:
  Pace pace_;
  std::vector<Eigen::Vector3d> places_;
};

/// Bodies at rest, which form one surface.
struct EdgeScene {
  std::vector<core::BlobView> bodies;
  /// From the frame of the path to that of the bodies.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  /// Signed distance from the surface, m, positive outside; position in the frame of the path.
  std::function<double(const Eigen::Vector3d&)> distance;
  /// Distance of a position from the crease of a resting hand, m.
  std::function<double(const Eigen::Vector3d&)> off;
};

/// Moves a hand along the path, and adds the result to `row`.
void follow(const EdgePath& path, const EdgeScene& around, CreaseResult& row);

}  // namespace tactree::evaluation
