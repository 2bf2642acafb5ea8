#include "normals/normals.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "geometry/spacing.hpp"
#include "normals/orient_cloud.hpp"
#include "sampling/resample.hpp"
#include "shapes.hpp"

namespace tactree::builder {
namespace {

struct Prepared {
  ZOrderedCloud dense;
  ZOrderedCloud points;  // with normals, oriented
  double spacing = 0.0;
  std::uint32_t pieces = 0;
};

Prepared prepare(Cloud cloud, double spacings = 1.0) {
  Prepared p;
  p.dense = ZOrderedCloud(std::move(cloud));
  const double own = estimate_spacing(p.dense).median_m;
  p.spacing = spacings * own;
  p.points = p.dense.subset(select_poisson_disk(p.dense, kDistanceOverSpacing * p.spacing));
  std::vector<Eigen::Vector3f> normals = estimate_normals(p.points, p.dense, p.spacing, own);
  std::vector<std::uint8_t> given;
  for (const Eigen::Vector3f& normal : p.points.normals()) {
    given.push_back(normal.isZero() ? 0 : 1);
  }
  const CloudOrientation orientation = orient_cloud({.points = p.points,
                                                     .spacing = p.spacing,
                                                     .dense = p.dense,
                                                     .dense_spacing = own,
                                                     .viewpoints = {},
                                                     .given = given},
                                                    normals);
  p.pieces = static_cast<std::uint32_t>(orientation.pieces.size());
  p.points.set_normals(std::move(normals));
  return p;
}

double degrees(double cosine) {
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

TEST(Normals, PointOutwardOnSphere) {
  const Prepared p = prepare(without_normals(random_sphere(30000, 0.03)), 2.0);
  EXPECT_EQ(p.pieces, 1U);
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const double cosine =
        p.points.normals()[i].cast<double>().dot(p.points.positions()[i].normalized());
    ASSERT_LT(degrees(cosine), 3.0);
  }
}

TEST(Normals, PointUpOnOpenSheet) {
  const double k = 100.0;
  const double height = 0.002;
  const Prepared p = prepare(cosine_sheet(120, 0.1, height, k));
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const Eigen::Vector3d& at = p.points.positions()[i];
    if (at.head<2>().cwiseAbs().maxCoeff() > 0.045) {
      continue;  // one-sided neighbourhoods
    }
    const Eigen::Vector3d exact(height * k * std::sin(k * at.x()),
                                height * k * std::sin(k * at.y()), 1.0);
    ASSERT_LT(degrees(p.points.normals()[i].cast<double>().dot(exact.normalized())), 3.0);
  }
}

TEST(Normals, PropagateAroundBoxEdges) {
  const Eigen::Vector3d low(-0.03, -0.02, -0.01);
  const Eigen::Vector3d high(0.03, 0.02, 0.01);
  Cloud cloud = without_normals(sample_faces(box_mesh(low, high), 0.002));
  const Prepared p = prepare(std::move(cloud), 1.5);
  EXPECT_EQ(p.pieces, 1U);
  std::size_t on_faces = 0;
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const Eigen::Vector3d face = box_face_at(p.points.positions()[i], low, high, 1e-9);
    if (!face.isZero()) {
      ++on_faces;
      ASSERT_GT(p.points.normals()[i].cast<double>().dot(face), 0.3);  // edges are blurred
    }
  }
  EXPECT_GT(on_faces, p.points.size() - 5U);
}

TEST(Normals, PointOutwardOnSeparateBodies) {
  Cloud cloud = without_normals(random_sphere(5000, 0.01, 1));
  for (const Eigen::Vector3d& p : random_sphere(5000, 0.01, 2).positions) {
    cloud.positions.push_back(p + Eigen::Vector3d(0.05, 0.0, 0.0));
  }
  const Prepared p = prepare(std::move(cloud));
  EXPECT_EQ(p.pieces, 2U);
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const Eigen::Vector3d centre(p.points.positions()[i].x() > 0.025 ? 0.05 : 0.0, 0.0, 0.0);
    ASSERT_GT(p.points.normals()[i].cast<double>().dot(p.points.positions()[i] - centre), 0.0);
  }
}

TEST(Normals, DoNotCrossThinPlate) {
  // Two spacings thick: neighbours on the far side are as near as those on the same side.
  const Eigen::Vector3d low(-0.03, -0.03, -0.001);
  const Eigen::Vector3d high(0.03, 0.03, 0.001);
  const Prepared p = prepare(without_normals(sample_faces(box_mesh(low, high), 0.001)));
  EXPECT_EQ(p.pieces, 1U);
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const Eigen::Vector3d& at = p.points.positions()[i];
    if (at.head<2>().cwiseAbs().maxCoeff() < 0.027) {
      ASSERT_GT(p.points.normals()[i].cast<double>().z() * at.z(), 0.9 * std::abs(at.z()));
    }
  }
}

TEST(Normals, StayConsistentOnParallelSheets) {
  // Separate sheets with borders two spacings apart: each has consistent normals.
  Cloud cloud;
  for (const double z : {0.0, 0.002}) {
    for (const Eigen::Vector3d& p : cosine_sheet(60, 0.06, 0.0, 1.0).positions) {
      cloud.positions.push_back(p + Eigen::Vector3d(0, 0, z));
    }
  }
  const Prepared p = prepare(std::move(cloud));
  std::size_t up[2] = {0, 0};
  std::size_t inner[2] = {0, 0};
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const Eigen::Vector3d& at = p.points.positions()[i];
    const std::size_t sheet = at.z() > 0.001 ? 1 : 0;
    if (at.head<2>().cwiseAbs().maxCoeff() < 0.027) {
      ++inner[sheet];
      up[sheet] += p.points.normals()[i].z() > 0.0F ? 1U : 0U;
    }
  }
  for (const std::size_t sheet : {0U, 1U}) {
    EXPECT_GT(inner[sheet], 1000U);
    EXPECT_TRUE(up[sheet] == 0U || up[sheet] == inner[sheet]) << up[sheet];
  }
}

TEST(Normals, FollowFewGivenNormals) {
  Cloud cloud = cosine_sheet(60, 0.06, 0.0, 1.0);
  cloud.normals.assign(cloud.size(), Eigen::Vector3f::Zero());
  for (std::size_t i = 0; i < cloud.size(); i += 50) {
    cloud.normals[i] = -Eigen::Vector3f::UnitZ();
  }
  const Prepared p = prepare(std::move(cloud));
  for (const Eigen::Vector3f& normal : p.points.normals()) {
    ASSERT_LT(normal.z(), -0.99F);
  }
}

TEST(Normals, AreIndependentOfThreads) {
  std::vector<Eigen::Vector3f> normals[2];
  for (std::size_t threads = 1; threads <= 2; ++threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    normals[threads - 1] = prepare(without_normals(random_sphere(20000, 0.03))).points.normals();
  }
  EXPECT_EQ(normals[0], normals[1]);
}

}  // namespace
}  // namespace tactree::builder
