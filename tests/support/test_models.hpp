#pragma once
// Analytic models for tests, and their blobs.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "tactree/builder/model.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::test {

/// z = cos x + cos y - 1.9689 on a grid: the paper's surface, shifted to the origin.
inline constexpr double kCosSheetOffset = 1.9689;
[[nodiscard]] double cos_sheet_height(double x, double y);
[[nodiscard]] builder::Model cos_sheet(double half_width_m, double spacing_m,
                                       core::Profile profile);

/// Points spread evenly (golden spiral) on a sphere around the origin.
[[nodiscard]] builder::Model sphere(double radius_m, double spacing_m);

/// Random points in a cube, for queries that must not assume a surface.
[[nodiscard]] builder::Model random_cloud(std::uint32_t points, double edge_m, double spacing_m,
                                          core::Profile profile, std::uint32_t seed);

/// The validated blob of a model. The constructor throws std::logic_error if it is invalid.
class TestBlob {
 public:
  explicit TestBlob(const builder::Model& model);
  [[nodiscard]] const core::BlobView& view() const { return view_; }
  [[nodiscard]] const builder::WrittenBlob& written() const { return written_; }
  /// Decoded points by index.
  [[nodiscard]] const std::vector<core::Vec3>& points() const { return points_; }

 private:
  builder::WrittenBlob written_;
  core::BlobView view_;
  std::vector<core::Vec3> points_;
};

}  // namespace tactree::test
