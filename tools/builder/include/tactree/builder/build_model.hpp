#pragma once
// From scans to a blob: the whole of `tactree build` but the command line.
//
//   read -> clean -> frame -> (sample) -> resample -> normals -> measure -> write -> check
//
// Everything is deterministic: the same input and options give the same bytes, whatever the number
// of threads. Lengths are metres of the model frame unless a name says otherwise.

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "tactree/builder/materials.hpp"
#include "tactree/builder/model.hpp"
#include "tactree/builder/progress.hpp"
#include "tactree/builder/scan.hpp"

namespace tactree::builder {

/// Support radius and reach of the surface fit, in spacings (docs/DESIGN.md).
inline constexpr double kSupportSpacings = 2.5;
inline constexpr double kReachSpacings = 3.0;

enum class UpAxis : std::uint8_t { kX, kY, kZ };

struct BuildOptions {
  double unit_m = 1.0;          ///< metres per unit of the source
  double scale = 1.0;           ///< and this factor on top
  std::optional<double> fit_m;  ///< scale so that the longest edge is this; implies `centre`
  bool centre = false;          ///< the middle of the bounding box becomes the origin
  UpAxis up = UpAxis::kZ;       ///< source axis that becomes the model's z
  std::optional<Eigen::AlignedBox3d> crop;  ///< source units and axes: what lies outside is dropped

  bool keep_outliers = false;
  bool flip_normals = false;  ///< the scan was oriented inside out

  std::optional<double> spacing_m;  ///< default: a cloud's own; a mesh's longest edge / 200
  bool resample = true;             ///< false: keep every distinct point
  std::optional<std::uint64_t>
      flash_budget_bytes;  ///< finest spacing whose blob fits; not with spacing_m

  core::Profile profile = core::Profile::kSurface;
  std::optional<MaterialMap> materials;  ///< none: the controller's configuration decides
  std::string name;                      ///< default: of the first input file
  unsigned threads = 0;                  ///< 0: as many as there are cores
};

/// A place where the surface ends.
struct Opening {
  enum class Kind : std::uint8_t {
    kHole,  ///< surface all around it
    kRim,   ///< an open end or edge of the surface
  };
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double diameter_m = 0.0;
  std::uint32_t points = 0;  ///< at its border
  Kind kind = Kind::kHole;
};

struct InputReport {
  std::string file;
  std::string format;
  std::uint64_t points = 0;
  std::uint64_t triangles = 0;
};

struct BuildReport {
  std::vector<InputReport> inputs;
  std::uint64_t input_points = 0;  ///< in the files; kept_points + what `dropped` counts of points
  std::uint64_t kept_points =
      0;  ///< after cleaning; what resampling chooses from (or the mesh's corners)
  std::map<std::string, std::uint64_t> dropped;  ///< cause -> count; causes with "face" count faces
  std::uint64_t sampled_points = 0;              ///< candidates made on a mesh's faces
  std::uint64_t thinned = 0;  ///< dropped so that no ball holds more than the board can take
  std::uint64_t merged = 0;   ///< fell on one site of the blob's lattice
  std::uint64_t output_points = 0;

  double spacing_m = 0.0;
  double largest_gap_m = 0.0;
  std::vector<Opening> openings;  ///< wider than the support radius, widest first
  std::uint32_t pieces = 0;       ///< connected pieces, where normals had to be estimated; else 0

  std::vector<std::uint64_t> material_points;  ///< points of the blob of each material

  double source_scale = 1.0;  ///< model metres per source unit
  Eigen::Vector3d source_origin = Eigen::Vector3d::Zero();
  Eigen::AlignedBox3d bounds;  ///< of the model

  std::uint64_t bytes = 0;
  double seconds = 0.0;
  std::uint64_t peak_rss_bytes = 0;
  std::vector<std::string> notes;     ///< what was decided, one sentence each
  std::vector<std::string> warnings;  ///< what the user should look at
};

struct BuildResult {
  WrittenBlob blob;
  BuildReport report;
};

/// Why nothing was built. `what()` is the whole message: file, cause and remedy.
class BuildError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads the files and builds one model of all of them. Throws ReadError or BuildError.
/// Cost: about 2 us and 150 bytes an input point, and 20 us an output point, on two cores.
[[nodiscard]] BuildResult build_model(std::span<const std::filesystem::path> inputs,
                                      const BuildOptions& options, Progress& progress);

/// The same from memory; `report.inputs` and the digest stay empty. Throws BuildError.
[[nodiscard]] BuildResult build_model(std::vector<Scan> scans, const BuildOptions& options,
                                      Progress& progress);

}  // namespace tactree::builder
