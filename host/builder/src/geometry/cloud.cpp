#include "geometry/cloud.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <type_traits>

namespace tactree::builder {
namespace {

// Calls visit(values) for each list of the cloud that is not empty, except the positions.
template <typename Visit>
void visit_attributes(Cloud& cloud, Visit&& visit) {
  const auto visit_if = [&](auto& values) {
    if (!values.empty()) {
      visit(values);
    }
  };
  visit_if(cloud.normals);
  visit_if(cloud.materials);
  visit_if(cloud.doubtful);
  visit_if(cloud.sights);
  visit_if(cloud.colours);
}

// Moves the values at(i) to the order of `order`.
template <typename At>
void reorder_values(std::span<const std::uint32_t> order, At&& at) {
  std::vector<std::remove_reference_t<decltype(at(0))>> moved(order.size());
  const auto for_all = [&](auto&& work) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, order.size(), 4096), [&](auto range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        work(i);
      }
    });
  };
  for_all([&](std::size_t i) { moved[i] = at(order[i]); });
  for_all([&](std::size_t i) { at(i) = moved[i]; });
}

}  // namespace

Box bounds_of(std::span<const Eigen::Vector3d> positions) {
  Box box;
  for (const Eigen::Vector3d& p : positions) {
    box.extend(p);
  }
  return box;
}

double largest_edge(const Box& box) { return box.isEmpty() ? 0.0 : box.sizes().maxCoeff(); }

Cloud select(const Cloud& cloud, std::span<const std::uint32_t> indices) {
  const auto selected = [&](const auto& values) {
    std::remove_cvref_t<decltype(values)> chosen;
    chosen.reserve(values.empty() ? 0 : indices.size());
    for (std::size_t k = 0; k < indices.size() && !values.empty(); ++k) {
      chosen.push_back(values[indices[k]]);
    }
    return chosen;
  };
  return {selected(cloud.positions), selected(cloud.normals), selected(cloud.materials),
          selected(cloud.doubtful),  selected(cloud.sights),  selected(cloud.colours)};
}

void keep(Cloud& cloud, std::span<const std::uint32_t> indices) {
  const auto keep_values = [&](auto& values) {
    for (std::size_t k = 0; k < indices.size(); ++k) {
      values[k] = values[indices[k]];
    }
    values.resize(indices.size());
  };
  keep_values(cloud.positions);
  visit_attributes(cloud, keep_values);
}

void reorder(Cloud& cloud, std::span<const std::uint32_t> order) {
  // One coordinate after the other: a copy of all three would take three times the memory.
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    reorder_values(order, [&](std::size_t i) -> double& { return cloud.positions[i][axis]; });
  }
  visit_attributes(cloud, [&](auto& values) {
    reorder_values(
        order, [&](std::size_t i) -> auto& { return values[i]; });
  });
}

}  // namespace tactree::builder
