#include "sampling/density.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "geometry/spacing.hpp"
#include "sampling/ball_bound.hpp"
#include "sampling/mesh_sampling.hpp"
#include "sampling/resample.hpp"
#include "tactree/builder/length_text.hpp"
#include "tactree/core/contact/surface.hpp"

namespace tactree::builder {
namespace {

constexpr double kMeshSpacingsPerExtent = 200.0;
constexpr double kLeastMeshPoints = 20'000.0;  // minimum for a long, thin object
// The points of a cloud are uneven, so their spacing after resampling is larger than requested. The
// requested spacing is kept up to this factor.
constexpr double kSparserThanWanted = 1.15;
// Maximum unevenness of a cloud without voids that the fit could not bridge at its own spacing.
constexpr double kMaxCloudUnevenness = 1.25;
constexpr int kInterpolations = 4;           // then the search bisects, which always ends
constexpr int kDistanceSteps = 128;          // between all points and an even selection
constexpr double kMaxUneven = 1.5;           // spacing after resampling over that of the scan
constexpr double kSameSpacing = 0.02;        // maximum relative difference
constexpr double kFallbackSpacing_m = 1e-3;  // for a single point

// No ball of `reach` may hold more than core::kMaxCandidates points. Thinning uses a wider ball and
// a smaller count, because the writer's bound is up to 1.1 times the true maximum and rounding
// moves the points.
constexpr double kThinningWider = 1.06;
constexpr double kThinningFewer = 0.875;

// Bytes per point of a blob: the initial value of the search for a flash budget.
constexpr double kTypicalBytesPerPoint = 6.4;
// The search ends above kBudgetUsed of the budget; each trial aims at kBudgetAimedAt.
constexpr double kBudgetUsed = 0.95;
constexpr double kBudgetAimedAt = 0.975;
constexpr int kBudgetTrials = 12;
constexpr double kBytesTwoSided = 2.2;  // bytes of a body built from a sheet / bytes of the sheet

// Range of a requested spacing; the lattice of a blob cannot represent any other.
constexpr double kFinestSpacing_m = 1e-9;
constexpr double kCoarsestSpacing_m = 1e6;

class DensityChooser {
 public:
  DensityChooser(CleanInput& input, const BuildOptions& options, Progress& progress,
                 BuildReport& report)
      : input_(input), options_(options), progress_(progress), report_(report) {
    if (input.mesh.triangles.empty()) {
      dense_ = std::move(input.points);
      dense_spacing_ = input.points_spacing;
    } else if (!options.resample) {
      throw std::runtime_error(
          "--no-resample needs a point cloud, the input is a mesh (choose a --spacing)");
    }
  }

  DensityChoice choose() {
    DensityChoice choice = options_.flash_budget_bytes ? fit_budget(*options_.flash_budget_bytes)
                                                       : choose_wanted(default_spacing());
    explain(choice);
    report_.thinned = thinned_;
    choice.dense = std::move(dense_);
    choice.dense_spacing_m = dense_spacing_;
    return choice;
  }

 private:
  [[nodiscard]] bool is_mesh() const { return !input_.mesh.triangles.empty(); }

  [[nodiscard]] double default_spacing() const {
    if (options_.spacing_m) {
      if (!(*options_.spacing_m >= kFinestSpacing_m && *options_.spacing_m <= kCoarsestSpacing_m)) {
        throw std::runtime_error(fmt::format(
            "--spacing {:.6g}: outside 1 nm .. 1000 km (give it in metres)", *options_.spacing_m));
      }
      return *options_.spacing_m;
    }
    const double own = is_mesh() ? mesh_spacing() : dense_spacing_;
    return own > 0.0 ? own : kFallbackSpacing_m;
  }

  // Finer for a long, thin object, but never so fine that the faces need too many samples.
  [[nodiscard]] double mesh_spacing() const {
    const double area = area_of(input_.mesh);
    const double by_size = largest_edge(input_.bounds) / kMeshSpacingsPerExtent;
    const double finest = 1.02 * std::sqrt(area / kMaxCandidates) / kCandidateDistance;
    return std::max(finest, std::min(by_size, std::sqrt(area / kLeastMeshPoints)));
  }

  // A mesh is sampled again for each spacing; the points of a cloud are fixed.
  void sample(double spacing) {
    if (!is_mesh()) {
      return;
    }
    dense_ = ZOrderedCloud();
    Cloud samples = sample_faces(input_.mesh, spacing);
    if (input_.crop.is_set()) {
      std::vector<std::uint32_t> inside;
      for (std::uint32_t i = 0; i < samples.size(); ++i) {
        if (input_.crop.contains(samples.positions[i])) {
          inside.push_back(i);
        }
      }
      keep(samples, inside);
    }
    report_.sampled_points = samples.size();
    const Cloud& points = input_.points.cloud();
    samples.positions.insert(samples.positions.end(), points.positions.begin(),
                             points.positions.end());
    samples.normals.insert(samples.normals.end(), points.normals.begin(), points.normals.end());
    samples.normals.resize(samples.size(), Eigen::Vector3f::Zero());
    samples.materials.insert(samples.materials.end(), points.materials.begin(),
                             points.materials.end());
    samples.colours.insert(samples.colours.end(), points.colours.begin(), points.colours.end());
    if (!samples.doubtful.empty()) {
      samples.doubtful.resize(samples.positions.size());
    }
    samples.sights.resize(points.has_sights() ? samples.positions.size() - points.size() : 0);
    samples.sights.insert(samples.sights.end(), points.sights.begin(), points.sights.end());
    if (samples.size() == 0) {
      throw std::runtime_error(fmt::format(
          "a spacing of {} is too coarse for this mesh: no sample point lies on it (lower "
          "--spacing)",
          length_text(spacing)));
    }
    dense_ = ZOrderedCloud(std::move(samples));
    dense_spacing_ = kCandidateDistance * spacing;
  }

  // If the requested spacing equals that of the scan, keeps the same points as without a request.
  DensityChoice choose_wanted(double wanted) {
    if (!is_mesh() && options_.spacing_m && wanted > dense_spacing_ &&
        wanted < kMaxUneven * dense_spacing_) {
      DensityChoice own = choose_at(dense_spacing_);
      if (std::abs(own.spacing_m / wanted - 1.0) < kSameSpacing) {
        return own;
      }
    }
    return choose_at(wanted);
  }

  DensityChoice choose_at(double wanted) {
    if (!is_mesh() && dense_spacing_ > kSparserThanWanted * wanted) {
      wanted = dense_spacing_;  // the scan has no more points
    }
    sample(wanted);
    DensityChoice choice;
    choice.spacing_m = wanted;
    if (options_.resample) {
      choice.points = dense_.subset(select_poisson_disk(dense_, kDistanceOverSpacing * wanted));
    } else {
      choice.points = dense_;
    }
    double own = is_mesh() ? 0.0 : estimate_spacing(choice.points).mean_m;
    if (own > (1.0 + kSameSpacing) * wanted && keeps_its_points()) {
      own = keep_more(wanted, own, choice);
    }
    if (own > kSparserThanWanted * wanted) {
      choice.spacing_m = own;
    }
    thin(choice);
    return choice;
  }

  /// True if a cloud that is not dense at the requested spacing may be thinned less evenly. Without
  /// a requested spacing it is not, because the spacing is then that of an even selection.
  [[nodiscard]] bool keeps_its_points() const {
    return options_.resample && options_.spacing_m && !is_mesh() &&
           estimate_spacing(dense_).unevenness <= kMaxCloudUnevenness;
  }

  /// Reduces the minimum distance until the points that are kept have the wanted spacing. `own` is
  /// their spacing at the full distance. Returns the spacing reached.
  double keep_more(double wanted, double own, DensityChoice& choice) const {
    double reached = estimate_spacing(dense_).mean_m;
    if (reached > wanted) {  // the cloud has no more points
      choice.points = dense_;
      return reached;
    }
    int low = 0;  // in steps: the largest distance found that leaves enough points
    int high = kDistanceSteps;
    double too_wide = own;  // spacing at `high`
    ZOrderedCloud kept;
    for (int count = 0; high - low > 1; ++count) {
      const double part = count < kInterpolations ? (wanted - reached) / (too_wide - reached) : 0.5;
      const int step = std::clamp(low + static_cast<int>(part * (high - low)), low + 1, high - 1);
      ZOrderedCloud trial = dense_.subset(
          select_poisson_disk(dense_, step * (kDistanceOverSpacing * wanted) / kDistanceSteps));
      const double spacing = estimate_spacing(trial).mean_m;
      if (spacing > wanted) {
        high = step;
        too_wide = spacing;
      } else {
        low = step;
        reached = spacing;
        kept = std::move(trial);
      }
    }
    if (low > 0) {
      choice.points = std::move(kept);
    } else {
      choice.points = dense_;
    }
    return reached;
  }

  void thin(DensityChoice& choice) {
    thinned_ = options_.profile == core::Profile::kSurface
                   ? thin_to_candidates(choice.points, choice.spacing_m)
                   : 0;
  }

  [[nodiscard]] std::uint64_t bytes_of(const DensityChoice& choice) const {
    Model model;
    model.positions = choice.points.positions();
    if (options_.pose) {  // the octree lies along the axes of the device
      for (Eigen::Vector3d& position : model.positions) {
        position = *options_.pose * position;
      }
    }
    model.normals.assign(model.positions.size(), Eigen::Vector3f::UnitZ());
    model.spacing_m = choice.spacing_m;
    model.support_radius_m = kSupportSpacings * choice.spacing_m;
    model.reach_m = kReachSpacings * choice.spacing_m;
    model.profile = options_.profile;
    if (options_.materials) {
      model.materials = options_.materials->list();
      model.material_indices.assign(model.positions.size(), 0);
    }
    // Whether it is a body is not known yet.
    const WrittenBlob blob = write_blob(model);
    const auto bytes = static_cast<double>(blob.bytes.size() + blob.interior_bytes_max);
    return static_cast<std::uint64_t>(options_.two_sided_m ? kBytesTwoSided * bytes : bytes);
  }

  // The finest spacing to try: that of a cloud, or for a mesh one from its area and the budget.
  [[nodiscard]] double first_trial(double budget) const {
    if (!is_mesh()) {
      return default_spacing();
    }
    const double points =
        std::max(1.0, (budget - sizeof(core::BlobHeader)) / kTypicalBytesPerPoint);
    const double sides = options_.two_sided_m ? kBytesTwoSided : 1.0;
    return std::sqrt(sides * area_of(input_.mesh) / points);
  }

  DensityChoice fit_budget(std::uint64_t budget) {
    double too_fine = 0.0;
    double fits = 0.0;
    std::optional<DensityChoice> best;
    std::uint64_t best_bytes = 0;
    double spacing = first_trial(static_cast<double>(budget));
    for (int trial = 0; trial < kBudgetTrials; ++trial) {
      progress_.begin(fmt::format("trying a spacing of {}", length_text(spacing)));
      DensityChoice choice = choose_at(spacing);
      const std::uint64_t bytes = bytes_of(choice);
      const bool fitting = bytes <= budget;
      (fitting ? fits : too_fine) = spacing;
      if (fitting && bytes > best_bytes) {
        best_bytes = bytes;
        best = std::move(choice);
        best_thinned_ = thinned_;
      }
      const bool finest = !is_mesh() && fitting && trial == 0;
      if (finest || static_cast<double>(best_bytes) >= kBudgetUsed * static_cast<double>(budget) ||
          (too_fine > 0.0 && fits > 0.0 && fits < 1.003 * too_fine)) {
        break;
      }
      spacing = next_trial(spacing, static_cast<double>(bytes) / static_cast<double>(budget),
                           too_fine, fits);
    }
    if (!best) {
      throw std::runtime_error(fmt::format(
          "no spacing gives a blob of at most {} bytes (raise --flash-budget, or --crop)", budget));
    }
    thinned_ = best_thinned_;
    return std::move(*best);
  }

  // The size is about proportional to 1 / spacing^2; bisects if that estimate leaves the bracket.
  static double next_trial(double spacing, double used, double too_fine, double fits) {
    const double next = spacing * std::clamp(std::sqrt(used / kBudgetAimedAt), 0.1, 10.0);
    if (too_fine > 0.0 && fits > 0.0 && !(next > too_fine && next < fits)) {
      return std::sqrt(too_fine * fits);
    }
    return next;
  }

  void explain(const DensityChoice& choice) {
    if (options_.spacing_m && choice.spacing_m > (1.0 + kSameSpacing) * *options_.spacing_m) {
      const bool thinned = report_.dropped.contains(kBeyondMemoryLimit);
      report_.warnings.push_back(
          fmt::format("the scan {} too coarse for a spacing of {}: {}, the distance of its points, "
                      "is used ({})",
                      thinned ? "was thinned to fit in the memory, and is" : "is",
                      length_text(*options_.spacing_m), length_text(choice.spacing_m),
                      thinned ? "raise --memory-limit" : "scan more finely, or build from a mesh"));
    }
    // With a share of three quarters, the spacing of the model is 15 % above that of the scan.
    if (options_.resample && !options_.spacing_m && !options_.flash_budget_bytes && !is_mesh() &&
        4 * choice.points.size() < 3 * dense_.size()) {
      report_.notes.push_back(fmt::format(
          "the points of the scan are spread unevenly: {} of {} are used, at an even spacing of {} "
          "(--no-resample uses all)",
          choice.points.size(), dense_.size(), length_text(choice.spacing_m)));
    }
    if (thinned_ > 0) {
      report_.warnings.push_back(fmt::format(
          "{} points were dropped: no ball of {} may hold more than {} points", thinned_,
          length_text(kReachSpacings * choice.spacing_m), core::kMaxCandidates));
    }
    if (choice.points.size() < 100) {
      report_.warnings.push_back(
          fmt::format("the model has only {} points, too few for a surface", choice.points.size()));
    }
  }

  CleanInput& input_;
  const BuildOptions& options_;
  Progress& progress_;
  BuildReport& report_;
  ZOrderedCloud dense_;
  double dense_spacing_ = 0.0;
  std::uint64_t thinned_ = 0;
  std::uint64_t best_thinned_ = 0;
};

}  // namespace

std::uint64_t thin_to_candidates(ZOrderedCloud& points, double spacing) {
  std::vector<std::uint64_t> rank(points.size());
  for (std::size_t i = 0; i < rank.size(); ++i) {
    rank[i] = hash64(i);
  }
  const std::vector<bool> kept =
      thin_to_ball_bound(points.positions(), rank, kThinningWider * kReachSpacings * spacing,
                         static_cast<std::uint32_t>(kThinningFewer * core::kMaxCandidates));
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < kept.size(); ++i) {
    if (kept[i]) {
      indices.push_back(i);
    }
  }
  const std::uint64_t thinned = kept.size() - indices.size();
  if (thinned > 0) {
    points.keep(indices);
  }
  return thinned;
}

DensityChoice choose_density(CleanInput& input, const BuildOptions& options, Progress& progress,
                             BuildReport& report) {
  return DensityChooser(input, options, progress, report).choose();
}

}  // namespace tactree::builder
