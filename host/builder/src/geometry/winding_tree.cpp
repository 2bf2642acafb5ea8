#include "geometry/winding_tree.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/cloud.hpp"

namespace tactree::builder {
namespace {

// Distance, in radii of a group, from which the group is approximated by one dipole.
constexpr double kFarRadii = 3.0;
constexpr std::uint32_t kLeafSize = 8;
// Size of the stack: twice the height of a balanced tree over 2^31 elements.
constexpr std::size_t kMaxOpen = 64;

constexpr std::uint32_t kWorthThread = 4096;  // elements

// Number of nodes of a tree over some elements, and of one over one element more.
struct NodeCounts {
  std::uint32_t of_this;
  std::uint32_t of_next;
};

NodeCounts nodes_over(std::uint32_t elements) {
  if (elements < kLeafSize) {
    return {1, 1};
  }
  const NodeCounts half = nodes_over(elements / 2);
  const std::uint32_t mixed = 1 + half.of_this + half.of_next;
  const bool even = elements % 2 == 0;
  const std::uint32_t split = even ? 1 + 2 * half.of_this : mixed;
  return {elements == kLeafSize ? 1 : split, even ? mixed : 1 + 2 * half.of_next};
}

double solid_angle(const SurfaceElement& element, const Eigen::Vector3d& d) {
  const double squared = d.squaredNorm();
  return squared > 0.0 ? element.area.dot(d) / (squared * std::sqrt(squared)) : 0.0;
}

}  // namespace

WindingTree::WindingTree(std::vector<SurfaceElement> elements) : elements_(std::move(elements)) {
  if (!elements_.empty()) {
    const auto count = static_cast<std::uint32_t>(elements_.size());
    nodes_.resize(nodes_over(count).of_this);
    set_node(0, 0, count);
  }
}

double WindingTree::angle(const Eigen::Vector3d& at) const {
  double sum = 0.0;
  std::array<std::uint32_t, kMaxOpen> open{};
  std::size_t count = nodes_.empty() ? 0 : 1;
  while (count > 0) {
    const std::uint32_t index = open[--count];
    const Node& node = nodes_[index];
    const Eigen::Vector3d d = node.sum.centre - at;
    if (d.squaredNorm() > kFarRadii * kFarRadii * node.radius * node.radius) {
      sum += solid_angle(node.sum, d);
    } else if (node.right != 0) {
      open[count++] = node.right;
      open[count++] = index + 1;
    } else {
      for (std::uint32_t k = node.first; k < node.last; ++k) {
        constexpr double kHalf = 2.0 * std::numbers::pi;
        sum += std::clamp(solid_angle(elements_[k], elements_[k].centre - at), -kHalf, kHalf);
      }
    }
  }
  return sum;
}

void WindingTree::set_node(std::uint32_t index, std::uint32_t first, std::uint32_t last) {
  Box box;
  SurfaceElement sum{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  double weight = 0.0;
  for (std::uint32_t k = first; k < last; ++k) {
    const double own = elements_[k].area.norm();
    box.extend(elements_[k].centre);
    sum.area += elements_[k].area;
    sum.centre += own * elements_[k].centre;
    weight += own;
  }
  sum.centre = weight > 0.0 ? (sum.centre / weight).eval() : box.center();
  double squared_radius = 0.0;
  for (std::uint32_t k = first; k < last; ++k) {
    squared_radius = std::max(squared_radius, (elements_[k].centre - sum.centre).squaredNorm());
  }
  nodes_[index] = {sum, std::sqrt(squared_radius), first, last, 0};
  if (last - first <= kLeafSize) {
    return;
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(elements_.begin() + first, elements_.begin() + middle, elements_.begin() + last,
                   [axis](const SurfaceElement& a, const SurfaceElement& b) {
                     return a.centre[axis] < b.centre[axis];
                   });
  const std::uint32_t right = index + 1 + nodes_over(middle - first).of_this;
  nodes_[index].right = right;
  if (last - first < kWorthThread) {
    set_node(index + 1, first, middle);
    set_node(right, middle, last);
    return;
  }
  tbb::parallel_invoke([&] { set_node(index + 1, first, middle); },
                       [&] { set_node(right, middle, last); });
}

}  // namespace tactree::builder
