#pragma once
// Builds a blob from scans: the implementation of `tactree build`.
//
//   read -> clean -> frame -> (sample) -> resample -> normals -> measure -> write -> check
//
// Deterministic: the same input and options give the same bytes for any number of threads. Lengths
// are metres in the model frame unless stated otherwise.

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "tactree/builder/materials.hpp"
#include "tactree/builder/model.hpp"
#include "tactree/builder/orientation.hpp"
#include "tactree/builder/progress.hpp"
#include "tactree/builder/read_scan.hpp"
#include "tactree/builder/scan.hpp"

namespace tactree::builder {

/// Support radius and reach of the surface fit, in point spacings (docs/DESIGN.md). From a radius
/// of 2.5 on, contact is not lost on irregular clouds and on those thinned by 60 %; a larger one
/// rounds more detail. A gather is valid within the difference, 0.5; a larger reach has more
/// candidates.
inline constexpr double kSupportSpacings = 2.5;
inline constexpr double kReachSpacings = 3.0;
/// Maximum width of a hole, in spacings, over which a hand keeps contact with the full force. In
/// wider ones the force fades, and from two support radii on a hand falls through.
inline constexpr double kBridgedSpacings = 3.75;

enum class UpAxis : std::uint8_t { kX, kY, kZ };

/// Whether the colours of the scans go to BuildResult::colours.
enum class KeepColours : std::uint8_t {
  kNo,
  kIfAny,    ///< if a scan has some
  kRequire,  ///< the build fails without colours
};

struct BuildOptions {
  ColumnMap columns;   ///< columns of text files of points; empty: detected in each file
  std::string format;  ///< format of all files, one of scan_formats(); empty: detected by content
  /// File that holds the content of the input "-"; empty if "-" is not standard input.
  std::filesystem::path standard_input;
  std::optional<double> unit_m;  ///< metres per unit of the source; default: as it states, or 1
  double scale = 1.0;            ///< additional factor
  std::optional<double> fit_m;   ///< scales the longest edge to this length; implies `centre`
  /// Returns the longest edge (m) to which a model of the given size (m) is scaled. Not with fit_m.
  std::function<double(const Eigen::Vector3d&)> fit_edge_m;
  bool centre = false;                      ///< the centre of the bounding box becomes the origin
  std::optional<UpAxis> up;                 ///< source axis that becomes the model's z; default: z
  double turn_deg = 0.0;                    ///< then about z, counterclockwise seen from above
  double placed_scale = 1.0;                ///< then about the origin of the model
  std::optional<Eigen::Isometry3d> pose;    ///< then turned and moved: the last step
  std::optional<Eigen::AlignedBox3d> crop;  ///< source units and axes: points outside are dropped

  double outlier_sigma = 3.0;  ///< drops points that are off a surface by more than this many times
                               ///< the noise of the scan; 0: keeps all points
  bool keep_largest = false;   ///< drops all connected components but the largest
  std::uint64_t min_piece = 0;  ///< drops components with fewer points (of a mesh: vertices)
  bool flip_normals = false;    ///< reverses all normals at the end
  OrientationRule orient = OrientationRule::kAuto;
  std::vector<Eigen::Vector3d> viewpoints;  ///< positions of the scanner, source units and axes

  std::optional<double> two_sided_m;  ///< the input is a sheet: build a body of this thickness

  std::optional<double> spacing_m;  ///< default: that of a cloud; longest edge of a mesh / 200
  bool resample = true;             ///< false: keep every distinct point
  std::optional<std::uint64_t>
      flash_budget_bytes;  ///< selects the finest spacing whose blob fits; not with spacing_m

  core::Profile profile = core::Profile::kSurface;
  std::optional<MaterialMap> materials;  ///< none: from the controller's configuration
  KeepColours keep_colours = KeepColours::kNo;
  /// Memory that the build may take. Of clouds with more points than fit, a part is read that is
  /// equally dense everywhere (ReadOptions::most_points). 0: half of that of the computer; else
  /// from 32 MiB.
  std::uint64_t memory_limit_bytes = 0;
  std::string name;      ///< default: name of the first input file
  unsigned threads = 0;  ///< 0: one per core
};

/// A hole or open edge of the surface.
struct Opening {
  enum class Kind : std::uint8_t {
    kHole,      ///< surrounded by surface
    kBoundary,  ///< an open end or edge of the object
  };
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double diameter_m = 0.0;   ///< of a hole: its width; of a boundary: its largest extent
  std::uint32_t points = 0;  ///< at its border
  Kind kind = Kind::kHole;
};

struct InputReport {
  std::string file;
  std::string format;
  std::uint64_t points = 0;
  std::uint64_t triangles = 0;
};

/// A step of a build, in the order of their beginning.
struct StageReport {
  std::string name;  ///< as the progress names it
  double seconds = 0.0;
  double cpu_seconds = 0.0;          ///< of all threads
  std::uint64_t points = 0;          ///< that the step processes; 0: unknown
  std::uint64_t peak_rss_bytes = 0;  ///< of the process, up to the end of the step
};

struct BuildReport {
  std::vector<InputReport> inputs;
  std::uint64_t input_points = 0;  ///< in the files: kept_points + dropped points
  std::uint64_t kept_points =
      0;  ///< after cleaning: input of the resampling (or vertices of the mesh)
  std::map<std::string, std::uint64_t> dropped;  ///< cause -> count; causes with "face" count faces
  std::uint64_t sampled_points = 0;              ///< candidates on the faces of a mesh
  std::uint64_t thinned = 0;  ///< dropped to respect the limit of points per ball
  std::uint64_t merged = 0;   ///< dropped because their lattice site was occupied
  std::uint64_t output_points = 0;

  double spacing_m = 0.0;
  double largest_gap_m = 0.0;
  double backed_share = 0.0;      ///< ratio of points with material behind; others are on sheets
  std::vector<Opening> openings;  ///< wider than kBridgedSpacings, widest first
  std::uint32_t pieces = 0;       ///< connected components if normals were estimated, else 0
  OrientationReport orientation;

  std::vector<std::uint64_t> material_points;  ///< points per material in the blob
  std::vector<ColourCount> colours;            ///< the most frequent ones of the input points
  std::vector<ColourMatch> colour_matches;     ///< one per colour of the materials

  bool unit_known = false;    ///< given by the user or stated by the source
  double source_scale = 1.0;  ///< model metres per source unit
  Eigen::Vector3d source_origin = Eigen::Vector3d::Zero();
  Eigen::AlignedBox3d bounds;  ///< of the model

  std::uint64_t bytes = 0;
  std::vector<StageReport> stages;
  double seconds = 0.0;
  std::uint64_t peak_rss_bytes = 0;
  std::vector<std::string> notes;     ///< decisions, one sentence each
  std::vector<std::string> warnings;  ///< one sentence each
};

struct BuildResult {
  WrittenBlob blob;
  BuildReport report;
  std::vector<std::uint8_t> doubtful;  ///< per point of the blob: 1 if its orientation is ambiguous
  /// Per point of the blob: the colour of the scan there, that of the nearest corner of a mesh.
  /// Empty if it is not kept.
  std::vector<Colour> colours;
};

/// The build failed. what() names file, cause and hint.
class BuildError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads the files and builds one model from all of them. Throws ReadError or BuildError.
/// Cost: about 2 us per input point and 20 us per output point on two cores, and up to 220 bytes
/// per input point.
[[nodiscard]] BuildResult build_model(std::span<const std::filesystem::path> inputs,
                                      const BuildOptions& options, Progress& progress);

/// Builds a model from scans in memory; `report.inputs` and the digest stay empty. Throws
/// BuildError.
[[nodiscard]] BuildResult build_model(std::vector<Scan> scans, const BuildOptions& options,
                                      Progress& progress);

}  // namespace tactree::builder
