#include "octree/rounding.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "octree/normal_code.hpp"

namespace tactree::builder {
namespace {

constexpr int kLast = 1023;

class Directions {
 public:
  Eigen::Vector3d next() {
    return Eigen::Vector3d(normal_(random_), normal_(random_), normal_(random_)).normalized();
  }
  Eigen::Vector3d position(double low, double high) {
    std::uniform_real_distribution<double> along(low, high);
    return {along(random_), along(random_), along(random_)};
  }

 private:
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

Eigen::Vector3d centre(const Eigen::Vector3i& site) {
  return (site.cast<double>().array() + 0.5).matrix();
}

Eigen::Vector3i containing(const Eigen::Vector3d& at) {
  return at.array().floor().cast<int>().matrix();
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

TEST(SiteOnPlane, IsNearThePlane) {
  Directions directions;
  double squares = 0.0;
  double squares_of_containing = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const Eigen::Vector3d at = directions.position(100.0, 900.0);
    const Eigen::Vector3d normal = directions.next();
    const Eigen::Vector3d error = centre(site_on_plane(at, normal, kLast)) - at;
    EXPECT_LE(error.cwiseAbs().maxCoeff(), kSiteReach);
    squares += std::pow(normal.dot(error), 2);
    squares_of_containing += std::pow(normal.dot(centre(containing(at)) - at), 2);
  }
  EXPECT_LT(std::sqrt(squares / squares_of_containing), 0.2);
}

TEST(SiteOnPlane, ContainsThePositionIfNoOtherIsNearer) {
  Directions directions;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d at = directions.position(100.0, 900.0);
    EXPECT_EQ(site_on_plane(at, Eigen::Vector3d::Zero(), kLast), containing(at));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(site_on_plane(at, Eigen::Vector3d::Unit(axis), kLast), containing(at));
      EXPECT_EQ(site_on_plane(at, -Eigen::Vector3d::Unit(axis), kLast), containing(at));
    }
  }
}

TEST(SiteOnPlane, ContainsAPositionBetweenTwoSites) {
  Directions directions;
  for (int i = 0; i < 1000; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3d at = directions.position(100.0, 900.0);
      at[axis] = std::floor(at[axis]);
      for (const double sign : {-1.0, 1.0}) {
        const Eigen::Vector3d inclined =
            sign * Eigen::Vector3d::Unit(axis) + 1e-7 * directions.next();
        EXPECT_EQ(site_on_plane(at, inclined.normalized(), kLast), containing(at));
      }
    }
  }
}

TEST(SiteOnPlane, IsInTheRoot) {
  Directions directions;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d normal = directions.next();
    for (const Eigen::Vector3d& at :
         {directions.position(-0.5, 1.0), directions.position(kLast, kLast + 1.5)}) {
      const Eigen::Vector3i site = site_on_plane(at, normal, kLast);
      EXPECT_GE(site.minCoeff(), 0);
      EXPECT_LE(site.maxCoeff(), kLast);
    }
  }
}

struct Face {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3f> normals;
};

/// A square grid of spacing 1 across the normal, ascending in z.
Face flat_face(const Eigen::Vector3d& normal, int half) {
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  Face face;
  for (int i = -half; i <= half; ++i) {
    for (int k = -half; k <= half; ++k) {
      face.positions.emplace_back(i * u + k * v);
    }
  }
  std::sort(face.positions.begin(), face.positions.end(),
            [](const auto& a, const auto& b) { return a.z() < b.z(); });
  face.normals.assign(face.positions.size(), normal.cast<float>());
  return face;
}

std::vector<std::uint32_t> encode(const Face& face, double radius) {
  std::vector<std::uint32_t> codes(face.positions.size());
  encode_normals(face.positions, face.normals, radius, codes);
  return codes;
}

/// The mean with the weights of a fit around the origin.
Eigen::Vector3d mean_normal(const Face& face, const std::vector<std::uint32_t>& codes) {
  constexpr double kSupport = 2.5;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const double u = 1.0 - face.positions[i].squaredNorm() / (kSupport * kSupport);
    sum += std::pow(std::max(u, 0.0), 4) * decode_normal(codes[i]);
  }
  return sum.normalized();
}

TEST(EncodeNormals, ErrorsOfNeighboursCancel) {
  Directions directions;
  double squares = 0.0;
  double squares_alone = 0.0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d normal = directions.next();
    const Face face = flat_face(normal, 5);
    squares += std::pow(angle_deg(mean_normal(face, encode(face, 1.6)), normal), 2);
    squares_alone += std::pow(angle_deg(mean_normal(face, encode(face, 0.0)), normal), 2);
  }
  EXPECT_LT(std::sqrt(squares / squares_alone), 0.4);
}

TEST(EncodeNormals, NoCodeIsFarFromItsNormal) {
  Directions directions;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d normal = directions.next();
    for (const std::uint32_t code : encode(flat_face(normal, 5), 1.6)) {
      EXPECT_LT(angle_deg(decode_normal(code), normal), 0.8);
    }
  }
}

TEST(EncodeNormals, FacesDoNotAffectEachOther) {
  Directions directions;
  Face face = flat_face(directions.next(), 5);
  const std::vector<std::uint32_t> alone = encode(face, 1.6);
  // A point of another face between any two, with a normal that its code does not represent.
  Face both;
  for (std::size_t i = 0; i < face.positions.size(); ++i) {
    both.positions.push_back(face.positions[i]);
    both.normals.push_back(face.normals[i]);
    both.positions.push_back(face.positions[i]);
    both.normals.push_back(-face.normals[i]);
  }
  const std::vector<std::uint32_t> codes = encode(both, 1.6);
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(codes[2 * i], alone[i]);
  }
}

}  // namespace
}  // namespace tactree::builder
