#pragma once
// The space around a point cloud that a ball can reach from far away without touching a point.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tactree::builder {

/// Grid of the positions that the centre of a ball of one radius can take on its path from
/// infinity.
/// Stored sparsely: a bitmap per block of 8 x 8 x 8 cells near a point, one flag per other block.
class Outside {
 public:
  /// The edge of a cell is radius / 2.5. Preconditions: finite positions, radius > 0.
  /// Deterministic. Cost: about 0.5 us per point; memory: about 10 bytes per point and one byte per
  /// block of the bounding box. A radius that would need more than 2^24 blocks is increased.
  Outside(std::span<const Eigen::Vector3d> positions, double radius);

  [[nodiscard]] double radius() const { return radius_; }

  struct Side {
    float evidence = 0.0F;  ///< 1: `normal` points outside, -1: its opposite, 0: unknown
    bool both = false;      ///< the ball touches the element from both sides
  };
  /// Determines which side of a surface element is outside.
  [[nodiscard]] Side side_of(const Eigen::Vector3d& position, const Eigen::Vector3f& normal) const;

 private:
  using Bits = std::array<std::uint64_t, 8>;  // one word per layer z; bit 8 y + x
  static constexpr std::uint32_t kFar = 0;    // a block without a bitmap, which has no blocked cell

  /// Precondition: in the grid, so that the conversion rounds down.
  [[nodiscard]] Eigen::Vector3i cell_at(const Eigen::Vector3d& position) const {
    return ((position - origin_) / edge_).cast<int>();
  }
  [[nodiscard]] bool reached_cell(const Eigen::Vector3f& in_cells) const;
  [[nodiscard]] std::size_t block_of(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(blocks_.y()) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(blocks_.x()) +
           static_cast<std::size_t>(x);
  }
  void lay_out(std::span<const Eigen::Vector3d> positions);
  void mark_blocks(const Eigen::Vector3d& p);
  void block_row(int first, int last, int y, int z);
  void block_ball(const Eigen::Vector3d& p);
  void block_around(std::span<const Eigen::Vector3d> positions);
  void reach_border();
  void flood();
  [[nodiscard]] Bits reached_bits(std::size_t block) const;
  [[nodiscard]] std::array<std::size_t, 6> neighbours_of(std::size_t block) const;
  bool spread(std::size_t block);
  [[nodiscard]] std::vector<std::size_t> entered_from(std::size_t block);

  double radius_;
  double edge_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  Eigen::Vector3i blocks_ = Eigen::Vector3i::Ones();
  std::vector<std::uint32_t> near_;        // block -> kFar or 1 + index in free_ and reached_
  std::vector<std::uint8_t> far_reached_;  // of blocks without a bitmap
  std::vector<Bits> free_;
  std::vector<Bits> reached_;
};

}  // namespace tactree::builder
