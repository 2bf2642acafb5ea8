#pragma once
// The test shapes: surfaces with known distances and normals, with probe positions and paths for
// slides.

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "tactree/evaluation/shapes.hpp"

namespace tactree::evaluation {

using Random = std::mt19937_64;

/// A position on the true surface; the normal points to the side of the probe.
struct Spot {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
};

/// A path on the surface, parametrised by its length.
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
  /// True normal at the point nearest to `p`; on an edge, that of the adjacent face closest to
  /// `answer`.
  std::function<Eigen::Vector3d(const Eigen::Vector3d& p, const Eigen::Vector3d& answer)> normal;
  std::function<Spot(Random&)> spot;
  std::vector<Path> paths{};
  double probe_depth_m = kSpacing;  // maximum depth of probes inside
  bool crossings = false;           // crossing the surface at any spot must cause contact
  bool friction = false;            // the paths allow a measurement of friction

  [[nodiscard]] double spacing_m() const {
    return static_cast<double>(shape.view().header().spacing_m);
  }
};

/// All subjects. The irregular and the thinned cosine sheet have `lines` paths, the other cosine
/// sheets a quarter of that.
[[nodiscard]] std::vector<Subject> make_subjects(std::uint32_t seed, int lines);

}  // namespace tactree::evaluation
