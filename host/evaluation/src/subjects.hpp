#pragma once
// What is touched: shapes whose truth is known, with the places to probe and the ways to slide.

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "tactree/evaluation/shapes.hpp"

namespace tactree::evaluation {

using Random = std::mt19937_64;

/// A place on the true surface; the normal points to the side it is touched from.
struct Spot {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
};

/// A way over the surface.
struct Path {
  std::function<Spot(double s_m)> spot;
  double length_m;
};

struct Subject {
  std::string name;  // key in the results
  std::string title;
  Shape shape;
  Shape paper;
  /// True signed distance of a position, m.
  std::function<double(const Eigen::Vector3d&)> distance;
  /// True normal where the surface is nearest to `p`; on an edge, of its faces the one closest to
  /// `answer`.
  std::function<Eigen::Vector3d(const Eigen::Vector3d& p, const Eigen::Vector3d& answer)> normal;
  std::function<Spot(Random&)> spot;
  std::vector<Path> paths{};
  double probe_depth_m = kSpacing;  // how far inside probes are placed
  bool crossings = false;           // wherever a spot is entered there is something to notice
  bool friction = false;            // the ratio of the forces is the coefficient along the paths

  [[nodiscard]] double spacing_m() const {
    return static_cast<double>(shape.view().header().spacing_m);
  }
};

/// All of them. `lines`: ways over each cosine sheet; the fewer, the quicker.
[[nodiscard]] std::vector<Subject> make_subjects(std::uint32_t seed, int lines);

}  // namespace tactree::evaluation
