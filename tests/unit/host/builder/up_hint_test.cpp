#include "up_hint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "shapes.hpp"
#include "tactree/builder/up_advice.hpp"

namespace tactree::builder {
namespace {

constexpr int kAround = 96;

/// A body of revolution about z: radius and height of its outline, from the axis at the bottom to
/// the axis at the top, closed.
Mesh turned(const std::vector<Eigen::Vector2d>& outline) {
  Mesh mesh;
  for (const Eigen::Vector2d& at : outline) {
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kAround;
      mesh.positions.emplace_back(at.x() * std::cos(angle), at.x() * std::sin(angle), at.y());
    }
  }
  for (std::size_t ring = 0; ring + 1 < outline.size(); ++ring) {
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const auto first = static_cast<std::uint32_t>(ring * kAround);
      const std::uint32_t next = (k + 1) % kAround;
      mesh.triangles.push_back({first + k, first + next, first + kAround + next});
      mesh.triangles.push_back({first + k, first + kAround + next, first + kAround + k});
    }
  }
  return mesh;
}

std::vector<Eigen::Vector2d> dome() {
  std::vector<Eigen::Vector2d> outline{{0.0, 0.0}};
  for (int k = 0; k <= 24; ++k) {
    const double angle = 0.5 * std::numbers::pi * k / 24;
    outline.emplace_back(0.04 * std::cos(angle), 0.04 * std::sin(angle));
  }
  return outline;
}

/// Closed below, open above.
const std::vector<Eigen::Vector2d> kMug = {{0.0, 0.0},    {0.03, 0.0},    {0.03, 0.08},
                                           {0.027, 0.08}, {0.027, 0.004}, {0.0, 0.004}};
const std::vector<Eigen::Vector2d> kCan = {{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.08}, {0.0, 0.08}};
const std::vector<Eigen::Vector2d> kCone = {{0.0, 0.0}, {0.03, 0.0}, {0.0, 0.08}};

/// Turns the model so that its z points along `up`, or against it.
Scan laid(Mesh mesh, UpAxis up, bool upside_down = false) {
  const int shift = up == UpAxis::kX ? 2 : up == UpAxis::kY ? 1 : 0;
  for (Eigen::Vector3d& p : mesh.positions) {
    if (upside_down) {
      p = Eigen::Vector3d(p.x(), -p.y(), -p.z());
    }
    p = Eigen::Vector3d(p[shift % 3], p[(1 + shift) % 3], p[(2 + shift) % 3]);
  }
  return mesh_scan(std::move(mesh));
}

std::string hint_of(Scan scan, std::optional<UpAxis> given = {}, double turn_deg = 0.0) {
  BuildOptions options;
  options.up = given;
  options.turn_deg = turn_deg;
  options.spacing_m = 0.001;
  std::vector<Scan> scans;
  scans.push_back(std::move(scan));
  Progress quiet;
  for (const std::string& note : build_model(std::move(scans), options, quiet).report.notes) {
    if (note.find("on its side") != std::string::npos) {
      return note;
    }
  }
  return "";
}

TEST(UpHint, NamesOptionForLyingBody) {
  for (const auto& outline : {dome(), kMug, kCone}) {
    EXPECT_NE(hint_of(laid(turned(outline), UpAxis::kY)).find("(--axis y turns it"),
              std::string::npos);
    EXPECT_NE(hint_of(laid(turned(outline), UpAxis::kX)).find("(--axis x turns it"),
              std::string::npos);
  }
}

TEST(UpHint, IsOmittedWhenUnneeded) {
  EXPECT_EQ(hint_of(laid(turned(dome()), UpAxis::kY), UpAxis::kZ), "");
  EXPECT_EQ(hint_of(laid(turned(dome()), UpAxis::kY), UpAxis::kY), "");
  for (const auto& outline : {dome(), kMug, kCone}) {
    EXPECT_EQ(hint_of(laid(turned(outline), UpAxis::kZ)), "");
  }
}

// --axis refers to the axes of the file, whatever --turn does after it.
TEST(UpHint, NamesFileAxisOfTurnedModel) {
  for (const double degrees : {90.0, 30.0}) {
    EXPECT_NE(hint_of(laid(turned(dome()), UpAxis::kY), {}, degrees).find("(--axis y turns it"),
              std::string::npos);
  }
}

BuildOptions coarse() {
  BuildOptions options;
  options.spacing_m = 0.001;
  return options;
}

std::optional<std::string> advice_on(Scan scan, const BuildOptions& options) {
  std::vector<Scan> scans;
  scans.push_back(std::move(scan));
  Progress quiet;
  const BuildResult result = build_model(std::move(scans), options, quiet);
  core::BlobView view;
  EXPECT_EQ(core::open_blob(result.blob.bytes, view), core::BlobStatus::kOk);
  return up_advice(view);
}

TEST(UpAdvice, RecognisesLyingBodyFromItsBlob) {
  BuildOptions options;
  options.spacing_m = 0.001;
  const auto advice = advice_on(laid(turned(dome()), UpAxis::kY), options);
  ASSERT_TRUE(advice);
  EXPECT_NE(advice->find("at its lowest y (build --axis y turns"), std::string::npos) << *advice;
  EXPECT_FALSE(advice_on(laid(turned(dome()), UpAxis::kZ), options));
  EXPECT_FALSE(advice_on(cloud_scan(even_sphere(20000, 0.03)), options));
  options.up = UpAxis::kY;
  EXPECT_FALSE(advice_on(laid(turned(dome()), UpAxis::kY), options));
}

// Without the interior, an open shell cannot be distinguished from a body.
TEST(UpAdvice, IsOmittedForBlobWithoutInterior) {
  BuildOptions options;
  options.spacing_m = 0.001;
  options.profile = core::Profile::kPaper;
  EXPECT_FALSE(advice_on(laid(turned(dome()), UpAxis::kY), options));
}

TEST(UpHint, IsOmittedForAmbiguousShape) {
  EXPECT_EQ(hint_of(mesh_scan(box_mesh({-0.01, -0.02, -0.03}, {0.01, 0.02, 0.03}))), "");
  EXPECT_EQ(hint_of(cloud_scan(even_sphere(20000, 0.03))), "");
  Cloud wall;  // a sheet that faces -y
  for (const Eigen::Vector3d& p : plane_grid(60, 1e-3).positions) {
    wall.positions.emplace_back(p.x(), 0.0, p.y());
  }
  EXPECT_EQ(hint_of(cloud_scan(std::move(wall))), "");
}

TEST(UpHint, RecognisesOpenBase) {
  const std::vector<Eigen::Vector2d> open(kCone.begin() + 1, kCone.end());  // a shell
  for (const char axis : {'x', 'y'}) {
    const std::string hint = hint_of(laid(turned(open), axis == 'x' ? UpAxis::kX : UpAxis::kY));
    const std::string expected = std::string("the opening of its base is at its lowest ") + axis;
    EXPECT_NE(hint.find(expected + " (--axis " + axis + " turns it"), std::string::npos) << hint;
  }
  EXPECT_EQ(hint_of(laid(turned(open), UpAxis::kZ)), "");
  const auto advice = advice_on(laid(turned(open), UpAxis::kY), coarse());
  ASSERT_TRUE(advice);
  EXPECT_NE(advice->find("the opening of its base is at its lowest y"), std::string::npos);
}

std::vector<Eigen::Vector2d> bulb() {
  std::vector<Eigen::Vector2d> outline;
  for (int k = 0; k <= 36; ++k) {
    const double angle = std::numbers::pi * (0.5 * k / 24 - 0.25);
    outline.emplace_back(0.04 * std::cos(angle), 0.04 * std::sin(angle));
  }
  return outline;
}

// Narrower than the body: a hand cannot reach its inside from below.
TEST(UpHint, RecognisesOpenBaseOfClosedBody) {
  EXPECT_NE(
      hint_of(laid(turned(bulb()), UpAxis::kY)).find("the opening of its base is at its lowest y"),
      std::string::npos);
  EXPECT_EQ(hint_of(laid(turned(bulb()), UpAxis::kZ)), "");
  EXPECT_EQ(hint_of(laid(turned(bulb()), UpAxis::kZ, true)), "");
}

// A relief is open behind.
TEST(UpHint, IsOmittedForShallowShell) {
  Mesh relief = turned({{0.04, 0.0}, {0.03, 0.02}, {0.0, 0.03}});
  EXPECT_EQ(hint_of(laid(std::move(relief), UpAxis::kY)), "");
}

// --axis alone would set it upside down.
TEST(UpHint, StatesThatBaseIsAtHighEnd) {
  const std::string hint = hint_of(laid(turned(dome()), UpAxis::kY, true));
  EXPECT_NE(hint.find("is at its highest y (--axis y sets y upright, with this base on top; --pose "
                      "turns it over"),
            std::string::npos)
      << hint;
  EXPECT_EQ(hint_of(laid(turned(dome()), UpAxis::kZ, true)), "");
}

/// A closed body, `length` times as long as wide, without a base.
Mesh spindle(double length) {
  std::vector<Eigen::Vector2d> outline;
  for (int k = 0; k <= 48; ++k) {
    const double angle = std::numbers::pi * k / 48;
    outline.emplace_back(0.02 * std::sin(angle), -0.02 * length * std::cos(angle));
  }
  return turned(outline);
}

TEST(UpHint, NamesLongestAxisAsPossibility) {
  EXPECT_NE(hint_of(laid(spindle(1.3), UpAxis::kY))
                .find("may lie on its side: it is longest along y (if that is up, --axis y turns"),
            std::string::npos);
  EXPECT_NE(
      hint_of(laid(spindle(2.0), UpAxis::kX)).find("longest along x (if that is up, --axis x"),
      std::string::npos);
  EXPECT_NE(hint_of(laid(turned(kCan), UpAxis::kY)).find("longest along y"), std::string::npos);
  EXPECT_EQ(hint_of(laid(spindle(1.2), UpAxis::kY)), "");
  EXPECT_EQ(hint_of(laid(spindle(2.0), UpAxis::kZ)), "");
  // A blob does not tell whether its builder knew.
  EXPECT_FALSE(advice_on(laid(spindle(2.0), UpAxis::kY), coarse()));
}

void add_mesh(Mesh& all, const Mesh& part) {
  const auto first = static_cast<std::uint32_t>(all.positions.size());
  all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
  for (const auto& [a, b, c] : part.triangles) {
    all.triangles.push_back({first + a, first + b, first + c});
  }
}

TEST(UpHint, IsOmittedForBodyThatStands) {
  EXPECT_EQ(hint_of(mesh_scan(box_mesh({0, 0, 0}, {0.02, 0.08, 0.02}))), "");
  Mesh bench = box_mesh({0, 0, 0.02}, {0.03, 0.08, 0.03});  // on four feet
  for (const double x : {0.0, 0.025}) {
    for (const double y : {0.0, 0.075}) {
      add_mesh(bench, box_mesh({x, y, 0}, {x + 0.005, y + 0.005, 0.02}));
    }
  }
  EXPECT_EQ(hint_of(mesh_scan(std::move(bench))), "");
  // The flat side of a plinth is no base of the body that lies on it.
  Mesh lying = spindle(2.5);
  add_mesh(lying, box_mesh({-0.02, -0.02, -0.06}, {0.02, 0.02, -0.045}));
  EXPECT_NE(hint_of(laid(std::move(lying), UpAxis::kY)), "");
}

// Standing on its open end, and longest along y.
TEST(UpHint, IsOmittedForBodyOpenBelow) {
  Mesh tub = box_mesh({0, 0, 0}, {0.03, 0.08, 0.03});
  std::erase_if(tub.triangles, [&](const auto& triangle) {
    return std::all_of(triangle.begin(), triangle.end(),
                       [&](std::uint32_t corner) { return tub.positions[corner].z() == 0.0; });
  });
  ASSERT_EQ(tub.triangles.size(), 10U);
  EXPECT_EQ(hint_of(mesh_scan(std::move(tub))), "");
}

TEST(UpHint, RequiresSingleLargeBase) {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3f> normals;
  const auto add = [&](int count, double y, const Eigen::Vector3f& normal) {
    for (int i = 0; i < count; ++i) {
      positions.emplace_back(1e-3 * (i % 40), y, 1e-3 * (i / 40));
      normals.push_back(normal);
    }
  };
  const auto is_lying = [&](std::size_t first = 0) {
    const auto posture = lying_posture(std::span(positions).subspan(first),
                                       std::span(normals).subspan(first), {}, 1e-3);
    return posture && posture->evidence == UpEvidence::kFlat;
  };
  add(300, 0.0, -Eigen::Vector3f::UnitY());
  add(300, 0.02, Eigen::Vector3f(0.6F, 0.8F, 0.0F));
  EXPECT_TRUE(is_lying());
  EXPECT_FALSE(is_lying(101));
  add(100, 0.02, Eigen::Vector3f::UnitY());
  EXPECT_TRUE(is_lying());
  add(1, 0.02, Eigen::Vector3f::UnitY());  // more than a third of the base
  EXPECT_FALSE(is_lying());
  add(601, 0.0, -Eigen::Vector3f::UnitY());
  EXPECT_FALSE(is_lying());  // 69 %
}

}  // namespace
}  // namespace tactree::builder
