#include "test_models.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

namespace tactree::test {
namespace {

void set_lengths(builder::Model& model, double spacing_m, core::Profile profile) {
  model.spacing_m = spacing_m;
  model.support_radius_m = 2.5 * spacing_m;
  model.reach_m = 3.0 * spacing_m;
  model.profile = profile;
}

}  // namespace

double cos_sheet_height(double x, double y) { return std::cos(x) + std::cos(y) - kCosSheetOffset; }

builder::Model cos_sheet(double half_width_m, double spacing_m, core::Profile profile) {
  builder::Model model;
  const int half = static_cast<int>(std::lround(half_width_m / spacing_m));
  for (int i = -half; i <= half; ++i) {
    for (int j = -half; j <= half; ++j) {
      const double x = i * spacing_m;
      const double y = j * spacing_m;
      model.positions.emplace_back(x, y, cos_sheet_height(x, y));
      model.normals.push_back(
          Eigen::Vector3d(std::sin(x), std::sin(y), 1.0).normalized().cast<float>());
    }
  }
  set_lengths(model, spacing_m, profile);
  return model;
}

builder::Model sphere(double radius_m, double spacing_m) {
  builder::Model model;
  const double area = 4.0 * std::numbers::pi * radius_m * radius_m;
  const int count = static_cast<int>(area / (spacing_m * spacing_m));
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double ring = std::sqrt(1.0 - z * z);
    const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const Eigen::Vector3d n(ring * std::cos(angle), ring * std::sin(angle), z);
    model.positions.emplace_back(radius_m * n);
    model.normals.push_back(n.cast<float>());
  }
  set_lengths(model, spacing_m, core::Profile::kSurface);
  return model;
}

builder::Model random_cloud(std::uint32_t points, double edge_m, double spacing_m,
                            core::Profile profile, std::uint32_t seed) {
  builder::Model model;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-0.5 * edge_m, 0.5 * edge_m);
  std::normal_distribution<float> direction;
  for (std::uint32_t i = 0; i < points; ++i) {
    const double x = place(random);
    const double y = place(random);
    const double z = place(random);
    model.positions.emplace_back(x, y, z);
    const float nx = direction(random);
    const float ny = direction(random);
    model.normals.push_back(Eigen::Vector3f(nx, ny, direction(random) + 1e-3F).normalized());
  }
  set_lengths(model, spacing_m, profile);
  return model;
}

TestBlob::TestBlob(const builder::Model& model) : written_(builder::write_blob(model)) {
  if (core::open_blob(written_.bytes, view_) != core::BlobStatus::kOk) {
    throw std::logic_error("the blob of a test model is invalid");
  }
  for (core::LeafCursor cursor(view_); !cursor.done(); cursor.next()) {
    const core::Leaf& leaf = cursor.leaf();
    for (std::uint32_t i = 0; i < leaf.point_count; ++i) {
      points_.push_back(view_.position(leaf, leaf.first_point + i));
    }
  }
}

}  // namespace tactree::test
