#include "sampling/mesh_sampling.hpp"

#include <gtest/gtest.h>

#include "sampling/resample.hpp"
#include "shapes.hpp"

namespace tactree::builder {
namespace {

const Eigen::Vector3d kLow(-0.03, -0.02, -0.01);
const Eigen::Vector3d kHigh(0.03, 0.02, 0.01);

TEST(MeshSampling, PointsKeepFaceAndNormal) {
  const Cloud samples = sample_faces(box_mesh(kLow, kHigh), 0.001);
  std::size_t on_edges = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d face = box_face_at(samples.positions[i], kLow, kHigh, 1e-12);
    if (face.isZero()) {
      ++on_edges;
      continue;
    }
    ASSERT_LT((samples.normals[i].cast<double>() - face).norm(), 1e-6);
  }
  EXPECT_LT(on_edges, 3U);
}

TEST(MeshSampling, SpreadsPointsByArea) {
  const double area = 2.0 * (0.06 * 0.04 + 0.06 * 0.02 + 0.04 * 0.02);
  const double spacing = 0.001;
  const Cloud samples = sample_faces(box_mesh(kLow, kHigh), spacing);
  const double expected = area / std::pow(kCandidateDistance * spacing, 2);
  EXPECT_NEAR(static_cast<double>(samples.size()), expected, 12.0);
  // Every square with the edge of the spacing on the top holds at least one of 7 points.
  std::vector<int> squares(60 * 40, 0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples.normals[i].z() > 0.5F) {
      const Eigen::Vector3d at = (samples.positions[i] - kLow) / spacing;
      ++squares[static_cast<std::size_t>(std::min(39, static_cast<int>(at.y())) * 60 +
                                         std::min(59, static_cast<int>(at.x())))];
    }
  }
  EXPECT_GT(*std::min_element(squares.begin(), squares.end()), 2);
  EXPECT_LT(*std::max_element(squares.begin(), squares.end()), 13);
}

TEST(MeshSampling, SamplesTinyFaces) {
  Mesh mesh;  // 1 cm^2 in 2 x 200 x 200 triangles, each a 50th of the area of a candidate
  constexpr std::uint32_t kSide = 200;
  for (std::uint32_t j = 0; j <= kSide; ++j) {
    for (std::uint32_t i = 0; i <= kSide; ++i) {
      mesh.positions.emplace_back(0.01 * i / kSide, 0.01 * j / kSide, 0.0);
    }
  }
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t a = j * (kSide + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + kSide + 1});
      mesh.triangles.push_back({a + 1, a + kSide + 2, a + kSide + 1});
    }
  }
  const double spacing = 0.0007;
  const double expected = 1e-4 / std::pow(kCandidateDistance * spacing, 2);
  const Cloud samples = sample_faces(mesh, spacing);
  EXPECT_NEAR(static_cast<double>(samples.size()), expected, 4.0 * std::sqrt(expected));
  const ZOrderedCloud points(samples);
  const std::size_t kept = select_poisson_disk(points, kDistanceOverSpacing * spacing).size();
  EXPECT_NEAR(static_cast<double>(kept) * spacing * spacing / 1e-4, 0.85, 0.05);
}

TEST(MeshSampling, DropsFacesWithoutArea) {
  Mesh mesh = box_mesh(kLow, kHigh);
  mesh.triangles.push_back({0, 0, 1});
  mesh.positions.push_back(0.5 * (mesh.positions[0] + mesh.positions[1]));
  mesh.triangles.push_back({0, 8, 1});
  const auto [degenerate, of_corners] = drop_faces(mesh, {});
  EXPECT_EQ(degenerate, 2U);
  EXPECT_EQ(of_corners, 0U);
  EXPECT_EQ(mesh.triangles.size(), 12U);
  std::vector<bool> keep(mesh.positions.size(), true);
  keep[0] = false;
  EXPECT_EQ(drop_faces(mesh, keep)[1], 3U);  // the faces around corner 0
}

TEST(MeshSampling, SuggestsSpacingForExcessPoints) {
  const Mesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  try {
    (void)sample_faces(mesh, 1e-4);
    FAIL() << "6 m^2 at 0.1 mm were accepted";
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    const std::size_t at = text.find("--spacing to ");
    ASSERT_NE(at, std::string::npos) << text;
    const double offered = std::stod(text.substr(at + 13));
    EXPECT_LE(area_of(mesh) / std::pow(kCandidateDistance * offered, 2), kMaxCandidates);
    EXPECT_LT(offered, 0.01);
  }
}

}  // namespace
}  // namespace tactree::builder
