#include "normals/mesh_windings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "cleaning/pieces.hpp"
#include "normals/piece_evidence.hpp"
#include "sampling/mesh_sampling.hpp"

namespace tactree::builder {
namespace {

constexpr double kFaceSamples = 40'000.0;  // samples, for the evidence about open shells
constexpr double kBallDistances = 2.5;     // radius of the finest ball, in distances of the samples
constexpr double kDecisive = 0.8;          // ratio of the evidence that decides
constexpr double kFlat = 1e-9;             // relative volume below which a shell has no inside
constexpr double kSmallShell = 1e-4;       // ratio of the area below which a shell gets no samples

struct Shell {
  std::vector<std::uint32_t> faces;
  Box box;
  double area = 0.0;
  double as_given = 0.0;  // area of the faces whose winding is kept, minus that of the others
  double volume = 0.0;    // six times the volume, with consistent windings
  bool closed = true;
  bool reversed = false;

  [[nodiscard]] bool consistent() const { return std::abs(as_given) > (1.0 - 1e-9) * area; }
};

// An edge of a face, given by its vertices in ascending order.
struct Side {
  std::uint32_t low;
  std::uint32_t high;
  std::uint32_t face;
  bool ascending;

  bool operator<(const Side& other) const {
    if (low != other.low) {
      return low < other.low;
    }
    return high != other.high ? high < other.high : face < other.face;
  }
};

class WindingMender {
 public:
  WindingMender(Mesh& mesh, OrientationRule rule, std::span<const Eigen::Vector3d> viewpoints)
      : mesh_(mesh), rule_(rule), viewpoints_(viewpoints), turned_(mesh.triangles.size(), 0) {}

  WindingRepair run() {
    collect_shells();
    orient_closed();
    orient_open();
    for (const Shell& shell : shells_) {
      for (const std::uint32_t f : shell.faces) {
        if ((turned_[f] != 0) != shell.reversed) {
          std::swap(mesh_.triangles[f][1], mesh_.triangles[f][2]);
          ++repair_.reversed_faces;
        }
      }
    }
    repair_.shells = static_cast<std::uint32_t>(shells_.size());
    repair_.watertight = std::all_of(shells_.begin(), shells_.end(),
                                     [](const Shell& shell) { return shell.closed; });
    return repair_;
  }

 private:
  [[nodiscard]] const Eigen::Vector3d& corner(std::uint32_t face, std::size_t k) const {
    return mesh_.positions[mesh_.triangles[face][k]];
  }
  // Normal by the given winding. Its length is twice the area.
  [[nodiscard]] Eigen::Vector3d normal_of(std::uint32_t face) const {
    return (corner(face, 1) - corner(face, 0)).cross(corner(face, 2) - corner(face, 0));
  }

  [[nodiscard]] std::vector<Side> sorted_sides() const {
    const std::vector<std::uint32_t> same = first_equal(mesh_.positions);
    std::vector<Side> sides;
    sides.reserve(3 * mesh_.triangles.size());
    for (std::uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = same[mesh_.triangles[f][k]];
        const std::uint32_t b = same[mesh_.triangles[f][(k + 1) % 3]];
        sides.push_back({std::min(a, b), std::max(a, b), f, a < b});
      }
    }
    std::sort(sides.begin(), sides.end());
    return sides;
  }

  void collect_shells() {
    const std::vector<Side> sides = sorted_sides();
    std::vector<std::array<std::uint32_t, 3>> across(mesh_.triangles.size(), {kNone, kNone, kNone});
    std::vector<std::uint8_t> boundary(mesh_.triangles.size(), 0);
    const auto link = [&](const Side& a, const Side& b) {
      // Faces that traverse their common edge in the same direction have opposite orientations.
      const std::uint32_t to = 2 * b.face + (a.ascending == b.ascending ? 1 : 0);
      *std::find(across[a.face].begin(), across[a.face].end(), kNone) = to;
    };
    for (std::size_t i = 0; i < sides.size();) {
      std::size_t end = i + 1;
      while (end < sides.size() && sides[end].low == sides[i].low &&
             sides[end].high == sides[i].high) {
        ++end;
      }
      if (end - i == 2 && sides[i].face != sides[i + 1].face) {
        link(sides[i], sides[i + 1]);
        link(sides[i + 1], sides[i]);
      }
      for (std::size_t k = i; k < end && (end - i) % 2 == 1; ++k) {
        boundary[sides[k].face] = 1;
      }
      i = end;
    }
    std::vector<bool> seen(mesh_.triangles.size(), false);
    for (std::uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
      if (!seen[f]) {
        shells_.push_back(shell_from(f, across, boundary, seen));
      }
    }
  }

  Shell shell_from(std::uint32_t first, const std::vector<std::array<std::uint32_t, 3>>& across,
                   const std::vector<std::uint8_t>& boundary, std::vector<bool>& seen) {
    Shell shell;
    shell.faces.push_back(first);
    seen[first] = true;
    for (std::size_t k = 0; k < shell.faces.size(); ++k) {
      const std::uint32_t f = shell.faces[k];
      shell.closed = shell.closed && boundary[f] == 0;
      const double sign = turned_[f] != 0 ? -1.0 : 1.0;
      const Eigen::Vector3d normal = normal_of(f);
      shell.area += normal.norm();
      shell.as_given += sign * normal.norm();
      shell.volume += sign * normal.dot(corner(f, 0) - mesh_.positions[mesh_.triangles[0][0]]);
      for (std::size_t c = 0; c < 3; ++c) {
        shell.box.extend(corner(f, c));
        const std::uint32_t to = across[f][c];
        if (to != kNone && !seen[to / 2]) {
          seen[to / 2] = true;
          turned_[to / 2] = turned_[f] ^ static_cast<std::uint8_t>(to % 2);
          shell.faces.push_back(to / 2);
        }
      }
    }
    return shell;
  }

  // Winding number of a shell with consistent windings, by solid angles (van Oosterom, Strackee).
  [[nodiscard]] double winding_of(const Shell& shell, const Eigen::Vector3d& at) const {
    double angle = 0.0;
    for (const std::uint32_t f : shell.faces) {
      const Eigen::Vector3d a = corner(f, 0) - at;
      const Eigen::Vector3d b = corner(f, 1) - at;
      const Eigen::Vector3d c = corner(f, 2) - at;
      const double la = a.norm();
      const double lb = b.norm();
      const double lc = c.norm();
      const double half = std::atan2(a.dot(b.cross(c)),
                                     la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
      angle += (turned_[f] != 0 ? -2.0 : 2.0) * half;
    }
    return angle / (4.0 * std::numbers::pi);
  }

  // Processes the largest shell first, so that a shell is processed after the shells around it.
  void orient_closed() {
    std::vector<std::uint32_t> order;
    for (std::uint32_t s = 0; s < shells_.size(); ++s) {
      if (shells_[s].closed) {
        order.push_back(s);
      }
    }
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return shells_[a].box.diagonal().norm() > shells_[b].box.diagonal().norm();
    });
    for (std::size_t k = 0; k < order.size(); ++k) {
      Shell& shell = shells_[order[k]];
      std::size_t around = 0;
      const Shell* inmost = nullptr;
      for (std::size_t outer = 0; outer < k; ++outer) {
        const Shell& other = shells_[order[outer]];
        const Eigen::Vector3d& at = corner(shell.faces[0], 0);
        if (other.box.contains(shell.box) && std::abs(winding_of(other, at)) > 0.5) {
          ++around;
          inmost = &other;
        }
      }
      if (inmost != nullptr && shell.consistent()) {
        const bool outer_was_turned = inmost->consistent() && was_turned(*inmost);
        shell.reversed = (shell.as_given < 0.0) != outer_was_turned;
      } else if (std::abs(shell.volume) < kFlat * std::pow(shell.area, 1.5)) {
        shell.reversed = shell.as_given < 0.0;
      } else {
        shell.reversed = (shell.volume < 0.0) != (around % 2 == 1);
      }
    }
  }

  // True if the faces of a consistent shell are reversed as a whole.
  [[nodiscard]] static bool was_turned(const Shell& shell) {
    return (shell.as_given < 0.0) != shell.reversed;
  }

  void orient_open() {
    double area = 0.0;
    double open = 0.0;
    for (const Shell& shell : shells_) {
      area += shell.area;
      open += shell.closed ? 0.0 : shell.area;
    }
    if (!(open > 0.0)) {
      return;
    }
    for (Shell& shell : shells_) {
      shell.reversed = shell.closed ? shell.reversed : shell.as_given < 0.0;
    }
    const bool stated = rule_ == OrientationRule::kUp ||
                        (rule_ != OrientationRule::kOutward && !viewpoints_.empty());
    if (stated) {
      for (Shell& shell : shells_) {
        shell.reversed = shell.closed ? shell.reversed : stated_height(shell) < 0.0;
      }
      return;
    }
    orient_by_evidence(area);
  }

  // Sum of the area components of the faces in the direction that the rule states, with consistent
  // windings.
  [[nodiscard]] double stated_height(const Shell& shell) const {
    double sum = 0.0;
    for (const std::uint32_t f : shell.faces) {
      Eigen::Vector3d towards = Eigen::Vector3d::UnitZ();
      if (rule_ != OrientationRule::kUp) {
        const auto nearest = std::min_element(
            viewpoints_.begin(), viewpoints_.end(),
            [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
              return (a - corner(f, 0)).squaredNorm() < (b - corner(f, 0)).squaredNorm();
            });
        towards = (*nearest - corner(f, 0)).normalized();
      }
      sum += (turned_[f] != 0 ? -1.0 : 1.0) * normal_of(f).dot(towards);
    }
    return sum;
  }

  void orient_by_evidence(double area) {
    const double distance = std::sqrt(0.5 * area / kFaceSamples);
    Cloud samples;
    std::vector<std::uint32_t> piece;
    for (std::uint32_t s = 0; s < shells_.size(); ++s) {
      const Shell& shell = shells_[s];
      if (shell.area < kSmallShell * area && shells_.size() > 100) {
        continue;
      }
      Mesh part;
      for (const std::uint32_t f : shell.faces) {
        const auto first = static_cast<std::uint32_t>(part.positions.size());
        for (std::size_t k = 0; k < 3; ++k) {
          part.positions.push_back(corner(f, k));
        }
        const std::uint32_t second = turned_[f] != 0 ? 2 : 1;
        part.triangles.push_back({first, first + second, first + 3 - second});
      }
      const Cloud own = sample_faces(part, distance / kCandidateDistance);
      samples.positions.insert(samples.positions.end(), own.positions.begin(), own.positions.end());
      samples.normals.insert(samples.normals.end(), own.normals.begin(), own.normals.end());
      piece.resize(samples.size(), s);
    }
    if (samples.size() == 0) {
      return;
    }
    const auto count = static_cast<std::uint32_t>(shells_.size());
    const Evidence evidence = find_evidence(samples.positions, samples.normals, piece, count,
                                            samples.positions, kBallDistances * distance);
    std::vector<double> sum(count, 0.0);
    for (std::size_t i = 0; i < piece.size(); ++i) {
      sum[piece[i]] += static_cast<double>(evidence.side[i]);
    }
    for (std::uint32_t s = 0; s < count; ++s) {
      Shell& shell = shells_[s];
      const PieceEvidence& found = evidence.pieces[s];
      if (shell.closed) {
        continue;
      }
      if (found.settled && found.one_sided > 0 &&
          std::abs(sum[s]) > (2.0 * kDecisive - 1.0) * found.one_sided) {
        shell.reversed = sum[s] < 0.0;
      } else {
        mesh_.doubtful.resize(mesh_.triangles.size());
        for (const std::uint32_t face : shell.faces) {
          mesh_.doubtful[face] = 1;
        }
        ++repair_.undecided_shells;
        repair_.undecided_share += shell.area / area;
      }
    }
  }

  static constexpr std::uint32_t kNone = ~0U;

  Mesh& mesh_;
  OrientationRule rule_;
  std::span<const Eigen::Vector3d> viewpoints_;
  std::vector<std::uint8_t> turned_;  // per face: 1 if reversed for consistency within its shell
  std::vector<Shell> shells_;
  WindingRepair repair_;
};

}  // namespace

WindingRepair repair_windings(Mesh& mesh, OrientationRule rule,
                              std::span<const Eigen::Vector3d> viewpoints) {
  return WindingMender(mesh, rule, viewpoints).run();
}

}  // namespace tactree::builder
