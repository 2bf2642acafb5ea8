#include "normals/piece_evidence.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

#include "geometry/cloud.hpp"
#include "normals/outside.hpp"

namespace tactree::builder {
namespace {

// Maximum ratio of points reached from both sides. Thin plates have such points at their edges, a
// body with a leak nearly everywhere.
constexpr double kMaxTwoSided = 0.25;
// Components with fewer points, absolute and as a ratio of all points, do not require a larger
// ball.
constexpr std::uint32_t kFewPoints = 30;
constexpr double kFewPart = 0.002;

class EvidenceSearch {
 public:
  EvidenceSearch(std::span<const Eigen::Vector3d> positions,
                 std::span<const Eigen::Vector3f> normals, std::span<const std::uint32_t> piece,
                 std::uint32_t pieces)
      : positions_(positions), normals_(normals), piece_(piece), found_(positions.size()) {
    evidence_.side.assign(positions.size(), 0.0F);
    evidence_.pieces.resize(pieces);
    for (const std::uint32_t p : piece) {
      ++evidence_.pieces[p].points;
    }
  }

  Evidence run(std::span<const Eigen::Vector3d> blockers, double finest) {
    const double extent = largest_edge(bounds_of(positions_));
    double radius = finest;
    do {
      test(Outside(blockers, radius));
      settle();
      if (radius == finest) {
        for (PieceEvidence& p : evidence_.pieces) {
          p.closed = p.settled;
        }
      }
      radius *= 2.0;
    } while (open_ && radius < extent);
    return std::move(evidence_);
  }

 private:
  void test(const Outside& outside) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions_.size(), 256), [&](auto range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        if (!evidence_.pieces[piece_[i]].settled) {
          found_[i] = outside.side_of(positions_[i], normals_[i]);
        }
      }
    });
  }

  void settle() {
    std::vector<PieceEvidence>& pieces = evidence_.pieces;
    std::vector<bool> was_settled(pieces.size());
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      was_settled[p] = pieces[p].settled;
      if (!pieces[p].settled) {
        pieces[p].one_sided = pieces[p].two_sided = 0;
      }
    }
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      if (!was_settled[piece_[i]]) {
        pieces[piece_[i]].one_sided += found_[i].evidence != 0.0F ? 1U : 0U;
        pieces[piece_[i]].two_sided += found_[i].both ? 1U : 0U;
      }
    }
    open_ = false;
    const double few =
        std::max<double>(kFewPoints, kFewPart * static_cast<double>(positions_.size()));
    for (PieceEvidence& p : pieces) {
      p.settled = p.settled || p.two_sided <= kMaxTwoSided * (p.one_sided + p.two_sided);
      open_ = open_ || (!p.settled && p.points > few);
    }
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      if (!was_settled[piece_[i]] && pieces[piece_[i]].settled) {
        evidence_.side[i] = found_[i].evidence;
      }
    }
  }

  std::span<const Eigen::Vector3d> positions_;
  std::span<const Eigen::Vector3f> normals_;
  std::span<const std::uint32_t> piece_;
  std::vector<Outside::Side> found_;
  Evidence evidence_;
  bool open_ = false;
};

}  // namespace

Evidence find_evidence(std::span<const Eigen::Vector3d> positions,
                       std::span<const Eigen::Vector3f> normals,
                       std::span<const std::uint32_t> piece, std::uint32_t pieces,
                       std::span<const Eigen::Vector3d> blockers, double finest) {
  return EvidenceSearch(positions, normals, piece, pieces).run(blockers, finest);
}

double winding_number(const Eigen::Vector3d& at, std::span<const Eigen::Vector3d> positions,
                      std::span<const Eigen::Vector3f> normals,
                      std::span<const std::uint32_t> piece, std::uint32_t without, double area) {
  double sum = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (piece[i] != without) {
      const Eigen::Vector3d d = positions[i] - at;
      const double squared = d.squaredNorm() + area;  // finite beside a point
      sum += d.dot(normals[i].cast<double>()) / (squared * std::sqrt(squared));
    }
  }
  return area * sum / (4.0 * std::numbers::pi);
}

}  // namespace tactree::builder
