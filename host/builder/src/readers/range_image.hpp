#pragma once
// Position of the scanner that recorded an image of points, row by row.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "tactree/builder/scan.hpp"

namespace tactree::builder {

/// Tests the position that a file states against the order of its points. Seen from the scanner,
/// neighbours to the right and below appear in the same order everywhere, at any distance. Some
/// files state the position in the frame of the points, others in another frame while the scanner
/// is at the origin of the points.
class RangeImage {
 public:
  /// `width` is the number of points per row; 0 if the points have no order. `certain` means that
  /// the format defines the position; rows from right to left are then accepted even if it is the
  /// origin.
  RangeImage(std::uint64_t width, const std::optional<Eigen::Vector3d>& stated,
             bool certain = false);

  /// Adds the next point of the file, also a missing one (NaN).
  void add(const Eigen::Vector3d& position);

  /// Returns nullopt if no position is stated or none fits.
  [[nodiscard]] std::optional<ScannerPose> pose() const;

 private:
  struct Candidate {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    std::uint64_t right = 0;     ///< triangles of neighbours in the order of an image
    std::uint64_t mirrored = 0;  ///< in the opposite order
  };
  [[nodiscard]] static bool most(std::uint64_t votes, const Candidate& of);

  std::size_t width_;
  std::size_t column_ = 0;
  std::vector<Eigen::Vector3d> last_row_;  // the last row; before column_, this row
  Eigen::Vector3d left_ = Eigen::Vector3d::Zero();
  bool stated_;
  bool certain_;
  Candidate as_stated_;
  Candidate at_origin_;
};

}  // namespace tactree::builder
