#pragma once
// Compares the points of a LAS file with the box that its header states: damaged records, and a
// damaged scale, give coordinates outside of it.

#include <Eigen/Core>
#include <cstdint>
#include <string>

namespace tactree::builder {

/// The smallest and the largest coordinates as the header states them.
struct LasBox {
  Eigen::Vector3d least = Eigen::Vector3d::Zero();
  Eigen::Vector3d most = Eigen::Vector3d::Zero();
};

class LasBoxCheck {
 public:
  /// `scale` is the distance of two coordinates that differ by 1 in the file. A box that is not
  /// finite or has no size is ignored.
  LasBoxCheck(const LasBox& box, const Eigen::Vector3d& scale);

  void add(const Eigen::Vector3d& position);

  /// True if the coordinates are those of wrong bytes: they fill the range of the numbers of the
  /// file, far outside of the box.
  [[nodiscard]] bool are_damaged() const;
  /// What is wrong; empty: nothing.
  [[nodiscard]] std::string message() const;

 private:
  LasBox box_;
  Eigen::Vector3d scale_;
  double size_ = 0.0;  // 0: the box is not usable
  std::uint64_t points_ = 0;
  std::uint64_t outside_ = 0;
  std::uint64_t far_outside_ = 0;
  Eigen::Vector3d least_;  // of the points
  Eigen::Vector3d most_;
};

}  // namespace tactree::builder
