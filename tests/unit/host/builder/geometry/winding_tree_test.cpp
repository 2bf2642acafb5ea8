#include "geometry/winding_tree.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "shapes.hpp"

namespace tactree::builder {
namespace {

constexpr double kWhole = 4.0 * std::numbers::pi;

std::vector<SurfaceElement> ball(std::size_t points) {
  const Cloud cloud = even_sphere(points, 1.0);
  std::vector<SurfaceElement> elements;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    elements.push_back({cloud.positions[i],
                        kWhole / static_cast<double>(points) * cloud.normals[i].cast<double>()});
  }
  return elements;
}

Eigen::Vector3d place(std::uint64_t k) {
  return 3.0 * Eigen::Vector3d(unit_random(3 * k) - 0.5, unit_random(3 * k + 1) - 0.5,
                               unit_random(3 * k + 2) - 0.5);
}

TEST(WindingTree, GivesWholeTurnInsideBody) {
  const WindingTree tree(ball(5000));
  for (std::uint64_t k = 0; k < 300; ++k) {
    const double radius = place(k).norm();
    if (std::abs(radius - 1.0) > 0.1) {
      EXPECT_NEAR(tree.angle(place(k)), radius < 1.0 ? kWhole : 0.0, 0.03 * kWhole) << radius;
    }
  }
}

TEST(WindingTree, AgreesWithElementSum) {
  const std::vector<SurfaceElement> elements = ball(3000);
  const WindingTree tree(elements);
  for (std::uint64_t k = 0; k < 100; ++k) {
    double sum = 0.0;
    for (const SurfaceElement& element : elements) {
      const Eigen::Vector3d d = element.centre - place(k);
      sum += std::clamp(element.area.dot(d) / std::pow(d.norm(), 3), -0.5 * kWhole, 0.5 * kWhole);
    }
    EXPECT_NEAR(tree.angle(place(k)), sum, 0.03 * kWhole);
  }
}

TEST(WindingTree, GivesHalfTurnOnSurface) {
  const std::vector<SurfaceElement> elements = ball(5000);
  const WindingTree tree(elements);
  for (std::size_t i = 0; i < elements.size(); i += 500) {
    EXPECT_NEAR(tree.angle(elements[i].centre), 0.5 * kWhole, 0.05 * kWhole);
  }
}

TEST(WindingTree, IsZeroWithoutElements) {
  EXPECT_EQ(WindingTree({}).angle(Eigen::Vector3d::Zero()), 0.0);
}

}  // namespace
}  // namespace tactree::builder
