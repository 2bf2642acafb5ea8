#include "normals/mesh_windings.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace tactree::builder {
namespace {

const Eigen::Vector3d kBoxLow(-0.03, -0.02, -0.01);
const Eigen::Vector3d kBoxHigh(0.03, 0.02, 0.01);

WindingRepair repair(Mesh& mesh, OrientationRule rule = OrientationRule::kAuto) {
  return repair_windings(mesh, rule, {});
}

void reverse(Mesh& mesh, std::size_t face) {
  std::swap(mesh.triangles[face][1], mesh.triangles[face][2]);
}

/// The triangles of `more`, behind those of `mesh`.
void append(Mesh& mesh, const Mesh& more) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
  for (const auto& [i, j, k] : more.triangles) {
    mesh.triangles.push_back({base + i, base + j, base + k});
  }
}

/// Each triangle with corners of its own, as in an STL file.
Mesh unwelded(const Mesh& mesh) {
  Mesh apart;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.positions.size());
    for (const std::uint32_t corner : triangle) {
      apart.positions.push_back(mesh.positions[corner]);
    }
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  return apart;
}

TEST(MeshWindings, AreKeptWhenCorrect) {
  Mesh mesh = box_mesh(kBoxLow, kBoxHigh);
  const auto before = mesh.triangles;
  EXPECT_EQ(repair(mesh).reversed_faces, 0U);
  EXPECT_EQ(mesh.triangles, before);
}

TEST(MeshWindings, AreReversedWhenInsideOut) {
  Mesh mesh = box_mesh(kBoxLow, kBoxHigh);
  const auto right = mesh.triangles;
  for (std::size_t f = 0; f < 12; ++f) {
    reverse(mesh, f);
  }
  EXPECT_EQ(repair(mesh).reversed_faces, 12U);
  EXPECT_EQ(mesh.triangles, right);
}

TEST(MeshWindings, AreRepairedWhenRandom) {
  const auto right = unwelded(box_mesh(kBoxLow, kBoxHigh)).triangles;
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    Mesh mesh = unwelded(box_mesh(kBoxLow, kBoxHigh));
    for (std::size_t f = 0; f < 12; ++f) {
      if (unit_random(100 * seed + f) < 0.5) {
        reverse(mesh, f);
      }
    }
    const WindingRepair done = repair(mesh);
    ASSERT_EQ(mesh.triangles, right);
    ASSERT_EQ(done.shells, 1U);
  }
}

TEST(MeshWindings, StayTurnedToHollow) {
  for (const bool inside_out : {false, true}) {
    Mesh hollow = box_mesh(0.5 * kBoxLow, 0.5 * kBoxHigh);
    for (std::size_t f = 0; f < 12; ++f) {
      reverse(hollow, f);
    }
    Mesh mesh = box_mesh(kBoxLow, kBoxHigh);
    append(mesh, hollow);
    const auto right = mesh.triangles;
    for (std::size_t f = 0; inside_out && f < 24; ++f) {
      reverse(mesh, f);
    }
    EXPECT_EQ(repair(mesh).reversed_faces, inside_out ? 24U : 0U);
    EXPECT_EQ(mesh.triangles, right);
  }
}

TEST(MeshWindings, AreKeptOnNestedBody) {
  Mesh mesh = box_mesh(kBoxLow, kBoxHigh);
  append(mesh, box_mesh(0.5 * kBoxLow, 0.5 * kBoxHigh));
  EXPECT_EQ(repair(mesh).reversed_faces, 0U);
}

TEST(MeshWindings, FollowOutsideOfOpenBox) {
  Mesh mesh = box_mesh(kBoxLow, kBoxHigh);
  mesh.triangles.resize(10);  // without one of the small ends
  const auto right = mesh.triangles;
  EXPECT_EQ(repair(mesh).reversed_faces, 0U);
  for (std::size_t f = 0; f < 10; ++f) {
    reverse(mesh, f);
  }
  EXPECT_EQ(repair(mesh).reversed_faces, 10U);
  EXPECT_EQ(mesh.triangles, right);
}

TEST(MeshWindings, FollowSheetMajorityOrRule) {
  Mesh sheet;
  sheet.positions = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}, {0, 0.1, 0}, {0.2, 0, 0}};
  sheet.triangles = {{0, 2, 1}, {0, 3, 2}, {1, 4, 2}};  // down, down, up
  Mesh mesh = sheet;
  const WindingRepair done = repair(mesh);
  EXPECT_EQ(done.reversed_faces, 1U);
  EXPECT_EQ(done.undecided_shells, 1U);
  EXPECT_NEAR(done.undecided_share, 1.0, 1e-12);
  mesh = sheet;
  EXPECT_EQ(repair(mesh, OrientationRule::kUp).reversed_faces, 2U);
}

}  // namespace
}  // namespace tactree::builder
