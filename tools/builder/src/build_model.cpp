#include "tactree/builder/build_model.hpp"

#include <fmt/core.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <future>

#include "ball_bound.hpp"
#include "cleaning.hpp"
#include "density.hpp"
#include "gaps.hpp"
#include "normals.hpp"
#include "sha256.hpp"
#include "tactree/builder/read_scan.hpp"
#include "tactree/core/blob.hpp"

namespace tactree::builder {
namespace {

// Sizes a hand can explore; outside, the unit is probably wrong.
constexpr double kHugeModel_m = 5.0;
constexpr double kTinyModel_m = 0.002;

Sha256Digest digest_of(std::span<const std::filesystem::path> files) {
  Sha256 sha;
  std::vector<char> buffer(1 << 20);
  for (const std::filesystem::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || in.gcount() > 0) {
      sha.update(std::as_bytes(std::span(buffer).first(static_cast<std::size_t>(in.gcount()))));
    }
  }
  return sha.digest();
}

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024U;
}

class Pipeline {
 public:
  Pipeline(const BuildOptions& options, Progress& progress)
      : options_(options), progress_(progress) {}

  [[nodiscard]] BuildReport& report() { return report_; }

  WrittenBlob run(std::vector<Scan> scans, const Sha256Digest& digest) {
    progress_.begin("cleaning");
    input_ = clean(std::move(scans), options_, report_);
    advise_on_unit();
    model_.profile = options_.profile;
    model_.name = options_.name;
    model_.source_digest = digest;
    model_.source_scale = report_.source_scale;
    model_.source_origin = report_.source_origin;
    if (options_.materials) {
      model_.materials = options_.materials->list();
    }
    progress_.begin("resampling");
    DensityChoice choice = choose_density(input_, options_, progress_, report_);
    model_.spacing_m = choice.spacing_m;
    model_.support_radius_m = kSupportSpacings * choice.spacing_m;
    model_.reach_m = kReachSpacings * choice.spacing_m;
    input_ = {};  // the choice holds what is still needed
    find_normals(choice);
    choice.dense = {};
    progress_.begin("looking for gaps");
    Gaps gaps = find_gaps(choice.points, model_.spacing_m, model_.support_radius_m);
    model_.largest_gap_m = gaps.largest_m;
    report_.openings = std::move(gaps.openings);
    return write(choice);
  }

 private:
  void advise_on_unit() {
    const double extent = largest_edge(input_.bounds);
    if (extent > kHugeModel_m || (extent < kTinyModel_m && extent > 0.0)) {
      report_.warnings.push_back(fmt::format(
          "the model is {:.4g} m wide: is its unit right? (--unit mm, or --fit 0.2 for 0.2 m)",
          extent));
    }
  }

  void find_normals(DensityChoice& choice) {
    const ZOrderedCloud& points = choice.points;
    std::vector<bool> known(points.size(), false);
    std::size_t count = 0;
    for (std::size_t i = 0; i < points.size() && points.cloud().has_normals(); ++i) {
      known[i] = !points.normals()[i].isZero();
      count += known[i] ? 1U : 0U;
    }
    if (count == points.size()) {
      return;
    }
    progress_.begin("estimating normals");
    std::vector<Eigen::Vector3f> normals =
        estimate_normals(points, choice.dense, model_.spacing_m, input_spacing(choice));
    report_.pieces =
        orient_normals(points, normals, count == 0 ? std::vector<bool>() : known, model_.spacing_m);
    if (options_.flip_normals && count == 0) {
      for (Eigen::Vector3f& n : normals) {
        n = -n;
      }
    }
    report_.notes.push_back(fmt::format(
        "{} of {} normals are estimated; the surface has {} connected piece{}",
        points.size() - count, points.size(), report_.pieces, report_.pieces == 1 ? "" : "s"));
    choice.points.set_normals(std::move(normals));
  }

  static double input_spacing(const DensityChoice& choice) {
    return choice.dense_spacing_m > 0.0 ? choice.dense_spacing_m : choice.spacing_m;
  }

  WrittenBlob write(const DensityChoice& choice) {
    progress_.begin("writing the octree");
    model_.positions = choice.points.positions();
    model_.normals = choice.points.normals();
    model_.material_indices = choice.points.cloud().materials;
    WrittenBlob blob = write_blob(model_);
    check(blob);
    count_materials(blob);
    report_.spacing_m = model_.spacing_m;
    report_.largest_gap_m = model_.largest_gap_m;
    report_.merged = blob.merged;
    report_.output_points = blob.source_index.size();
    report_.bounds = bounds_of(model_.positions);
    report_.bytes = blob.bytes.size();
    return blob;
  }

  void count_materials(const WrittenBlob& blob) {
    report_.material_points.assign(model_.materials.size(), 0);
    for (const std::uint32_t source : blob.source_index) {
      if (!model_.materials.empty()) {
        ++report_
              .material_points[model_.material_indices.empty() ? 0
                                                               : model_.material_indices[source]];
      }
    }
    for (std::size_t i = 1; i < report_.material_points.size(); ++i) {
      if (report_.material_points[i] == 0) {
        report_.warnings.push_back(
            fmt::format("no point has the colour of the material '{}' (raise its tolerance)",
                        options_.materials->colours[i - 1].name));
      }
    }
  }

  // Reads the blob back the way the board will, and compares.
  void check(const WrittenBlob& blob) const {
    core::BlobView view;
    const core::BlobStatus status = core::open_blob(blob.bytes, view);
    if (status != core::BlobStatus::kOk || view.point_count() != blob.source_index.size()) {
      throw std::logic_error(
          fmt::format("the blob just written is not valid: {}", core::describe(status)));
    }
    core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
      const core::Vec3 p = view.position(leaf, index);
      const Eigen::Vector3d decoded(static_cast<double>(p.x), static_cast<double>(p.y),
                                    static_cast<double>(p.z));
      const double off =
          (decoded - model_.positions[blob.source_index[index]]).cwiseAbs().maxCoeff();
      const double cell = std::ldexp(static_cast<double>(view.step_m()),
                                     static_cast<int>(view.depth() - leaf.level));
      if (!(off <= 1.0001 * cell)) {
        throw std::logic_error(
            fmt::format("point {} of the blob just written is {} m off", index, off));
      }
    });
  }

  const BuildOptions& options_;
  Progress& progress_;
  BuildReport report_;
  CleanInput input_;
  Model model_;
};

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::unique_ptr<tbb::global_control> limit_threads(unsigned threads) {
  return threads == 0 ? nullptr
                      : std::make_unique<tbb::global_control>(
                            tbb::global_control::max_allowed_parallelism, threads);
}

BuildResult finish(Pipeline& pipeline, std::vector<Scan> scans, const Sha256Digest& digest,
                   const std::string& label, const Stopwatch& stopwatch, Progress& progress) {
  try {
    BuildResult result;
    result.blob = pipeline.run(std::move(scans), digest);
    result.report = std::move(pipeline.report());
    result.report.seconds = stopwatch.seconds();
    result.report.peak_rss_bytes = peak_rss_bytes();
    progress.end();
    return result;
  } catch (const std::runtime_error& error) {
    throw BuildError(label.empty() ? error.what() : label + ": " + error.what());
  }
}

std::string label_of(std::span<const std::filesystem::path> inputs) {
  if (inputs.size() == 1) {
    return inputs[0].string();
  }
  return fmt::format("{} and {} more", inputs[0].string(), inputs.size() - 1);
}

}  // namespace

BuildResult build_model(std::span<const std::filesystem::path> inputs, const BuildOptions& options,
                        Progress& progress) {
  if (inputs.empty()) {
    throw BuildError("no input file");
  }
  const Stopwatch stopwatch;
  const auto limit = limit_threads(options.threads);
  std::future<Sha256Digest> digest = std::async(
      options.threads == 1 ? std::launch::deferred : std::launch::async, digest_of, inputs);
  BuildOptions named = options;
  if (named.name.empty()) {
    named.name = inputs[0].stem().string();
  }
  Pipeline pipeline(named, progress);
  std::vector<Scan> scans;
  for (const std::filesystem::path& file : inputs) {
    progress.begin("reading " + file.filename().string());
    ReadOptions reading;
    reading.progress = [&](double fraction) { progress.advance(fraction); };
    scans.push_back(read_scan(file, reading));
    const Scan& scan = scans.back();
    pipeline.report().inputs.push_back(
        {file.string(), scan.format, scan.positions.size(), scan.triangles.size()});
  }
  return finish(pipeline, std::move(scans), digest.get(), label_of(inputs), stopwatch, progress);
}

BuildResult build_model(std::vector<Scan> scans, const BuildOptions& options, Progress& progress) {
  const Stopwatch stopwatch;
  const auto limit = limit_threads(options.threads);
  Pipeline pipeline(options, progress);
  return finish(pipeline, std::move(scans), {}, "", stopwatch, progress);
}

}  // namespace tactree::builder
