#include "density.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "ball_bound.hpp"
#include "resample.hpp"
#include "spacing.hpp"
#include "tactree/core/surface.hpp"

namespace tactree::builder {
namespace {

constexpr double kMeshSpacingsPerExtent = 200.0;
// A cloud's points are not spread evenly, so after resampling they are sparser than one a square of
// the spacing; up to this factor the spacing asked for still holds.
constexpr double kSparser = 1.15;
constexpr double kFallbackSpacing_m = 1e-3;  // of a single point

// No ball of `reach` may hold more than core::kMaxCandidates points. Thinning is done for a ball
// wider and a count smaller than that, so that the writer's bound, which is at most 1.1 times the
// true maximum of points that were moved by rounding, stays below.
constexpr double kThinningWider = 1.06;
constexpr double kThinningFewer = 0.875;

// A blob's bytes a point, to begin the search for a budget with.
constexpr double kTypicalBytesPerPoint = 6.4;
constexpr double kBudgetUsed = 0.95;
constexpr double kBudgetAimedAt = 0.975;
constexpr int kBudgetTrials = 12;

std::string in_millimetres(double metres) { return fmt::format("{:.4g} mm", 1e3 * metres); }

class DensityChooser {
 public:
  DensityChooser(CleanInput& input, const BuildOptions& options, Progress& progress,
                 BuildReport& report)
      : input_(input), options_(options), progress_(progress), report_(report) {
    if (input.mesh.triangles.empty()) {
      dense_ = std::move(input.points);
      dense_spacing_ = input.points_spacing;
    } else if (!options.resample) {
      throw std::runtime_error("a mesh has no points of its own to keep (give a --spacing)");
    }
  }

  DensityChoice choose() {
    DensityChoice choice = options_.flash_budget_bytes ? fit_budget(*options_.flash_budget_bytes)
                                                       : choose_at(default_spacing());
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
      return *options_.spacing_m;
    }
    const double own =
        is_mesh() ? largest_edge(input_.bounds) / kMeshSpacingsPerExtent : dense_spacing_;
    return own > 0.0 ? own : kFallbackSpacing_m;
  }

  // A mesh is sampled anew for each spacing; a cloud is what it is.
  void sample(double spacing) {
    if (!is_mesh()) {
      return;
    }
    dense_ = ZOrderedCloud();
    Cloud samples = sample_faces(input_.mesh, spacing);
    if (!input_.crop.isEmpty()) {
      std::vector<std::uint32_t> inside;
      for (std::uint32_t i = 0; i < samples.size(); ++i) {
        if (input_.crop.contains(samples.positions[i])) {
          inside.push_back(i);
        }
      }
      samples = select(samples, inside);
    }
    report_.sampled_points = samples.size();
    const Cloud& points = input_.points.cloud();
    samples.positions.insert(samples.positions.end(), points.positions.begin(),
                             points.positions.end());
    samples.normals.insert(samples.normals.end(), points.normals.begin(), points.normals.end());
    samples.normals.resize(samples.size(), Eigen::Vector3f::Zero());
    samples.materials.insert(samples.materials.end(), points.materials.begin(),
                             points.materials.end());
    if (samples.size() == 0) {
      throw std::runtime_error(
          fmt::format("a spacing of {} is too coarse for this mesh: no point falls on it (lower "
                      "--spacing)",
                      in_millimetres(spacing)));
    }
    dense_ = ZOrderedCloud(std::move(samples));
    dense_spacing_ = kCandidateDistance * spacing;
  }

  DensityChoice choose_at(double wanted) {
    if (!is_mesh() && dense_spacing_ > kSparser * wanted) {
      wanted = dense_spacing_;  // nobody can invent points
    }
    sample(wanted);
    DensityChoice choice;
    choice.spacing_m = wanted;
    if (options_.resample) {
      choice.points = dense_.subset(select_poisson_disk(dense_, kDistanceOverSpacing * wanted));
    } else {
      choice.points = dense_;
    }
    const double own = is_mesh() ? 0.0 : estimate_spacing(choice.points).mean_m;
    if (own > kSparser * wanted) {
      choice.spacing_m = own;
    }
    thin(choice);
    return choice;
  }

  void thin(DensityChoice& choice) {
    thinned_ = 0;
    if (options_.profile != core::Profile::kSurface) {
      return;
    }
    std::vector<std::uint64_t> rank(choice.points.size());
    for (std::size_t i = 0; i < rank.size(); ++i) {
      rank[i] = hash64(i);
    }
    const std::vector<bool> kept = thin_to_ball_bound(
        choice.points.positions(), rank, kThinningWider * kReachSpacings * choice.spacing_m,
        static_cast<std::uint32_t>(kThinningFewer * core::kMaxCandidates));
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < kept.size(); ++i) {
      if (kept[i]) {
        indices.push_back(i);
      }
    }
    thinned_ = kept.size() - indices.size();
    if (thinned_ > 0) {
      choice.points = choice.points.subset(indices);
    }
  }

  [[nodiscard]] std::uint64_t bytes_of(const DensityChoice& choice) const {
    Model model;
    model.positions = choice.points.positions();
    model.normals.assign(model.positions.size(), Eigen::Vector3f::UnitZ());
    model.spacing_m = choice.spacing_m;
    model.support_radius_m = kSupportSpacings * choice.spacing_m;
    model.reach_m = kReachSpacings * choice.spacing_m;
    model.profile = options_.profile;
    if (options_.materials) {
      model.materials = options_.materials->list();
      model.material_indices.assign(model.positions.size(), 0);
    }
    return write_blob(model).bytes.size();
  }

  // The finest spacing to try: a cloud's own; a mesh's from its area, as there is no finest.
  [[nodiscard]] double first_trial(double budget) const {
    if (!is_mesh()) {
      return default_spacing();
    }
    const double points =
        std::max(1.0, (budget - sizeof(core::BlobHeader)) / kTypicalBytesPerPoint);
    return std::sqrt(area_of(input_.mesh) / points);
  }

  DensityChoice fit_budget(std::uint64_t budget) {
    double too_fine = 0.0;
    double fits = 0.0;
    std::optional<DensityChoice> best;
    std::uint64_t best_bytes = 0;
    double spacing = first_trial(static_cast<double>(budget));
    for (int trial = 0; trial < kBudgetTrials; ++trial) {
      progress_.begin(fmt::format("trying a spacing of {}", in_millimetres(spacing)));
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
    tell_budget(best_bytes, budget, best->spacing_m);
    thinned_ = best_thinned_;
    return std::move(*best);
  }

  // A surface's bytes go with 1 / spacing^2; where that leads out of the bracket, halve it.
  static double next_trial(double spacing, double used, double too_fine, double fits) {
    const double next = spacing * std::clamp(std::sqrt(used / kBudgetAimedAt), 0.1, 10.0);
    if (too_fine > 0.0 && fits > 0.0 && !(next > too_fine && next < fits)) {
      return std::sqrt(too_fine * fits);
    }
    return next;
  }

  void tell_budget(std::uint64_t bytes, std::uint64_t budget, double spacing) {
    const double part = 100.0 * static_cast<double>(bytes) / static_cast<double>(budget);
    report_.notes.push_back(fmt::format(
        "the flash budget of {} bytes allows a spacing of {}: {} bytes, {:.1f} % of it{}", budget,
        in_millimetres(spacing), bytes, part,
        part < 90.0 && !is_mesh() ? "; the scan has no finer detail" : ""));
  }

  void explain(const DensityChoice& choice) {
    if (options_.spacing_m && choice.spacing_m > *options_.spacing_m) {
      report_.warnings.push_back(fmt::format(
          "the scan is too coarse for a spacing of {}: its points are {} apart, which is used "
          "(scan more finely, or build from a mesh)",
          in_millimetres(*options_.spacing_m), in_millimetres(choice.spacing_m)));
    }
    if (thinned_ > 0) {
      report_.warnings.push_back(
          fmt::format("{} points were thinned out: no ball of {} may hold more than {}", thinned_,
                      in_millimetres(kReachSpacings * choice.spacing_m), core::kMaxCandidates));
    }
    if (choice.points.size() < 100) {
      report_.warnings.push_back(
          fmt::format("{} points are hardly a surface to touch", choice.points.size()));
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

DensityChoice choose_density(CleanInput& input, const BuildOptions& options, Progress& progress,
                             BuildReport& report) {
  return DensityChooser(input, options, progress, report).choose();
}

}  // namespace tactree::builder
