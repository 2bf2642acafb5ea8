#pragma once
// Evaluation of both modes: accuracy on shapes with known distances, the paper's experiments, the
// closed loop, and real scans.
//
// Deterministic: the same options give the same results. A value that does not apply is NaN (null
// in JSON).

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tactree/builder/build_model.hpp"
#include "tactree/builder/progress.hpp"

namespace tactree::evaluation {

/// Longest edge to which scans are scaled, unless they are evaluated alone.
inline constexpr double kModelEdge_m = 0.1;

struct Options {
  bool quick = false;      ///< fewer probes and lines: seconds instead of minutes, for tests
  std::uint32_t seed = 1;  ///< of the random numbers
  std::vector<std::filesystem::path> scans;
  std::string format;          ///< of the scans; empty: detected by content
  builder::ColumnMap columns;  ///< of scans that are text files; empty: detected in each
  bool scans_only = false;     ///< omit everything but the scans, also in the reports, and keep
                               ///< their sizes
};

/// The two modes. The elements of all arrays below are in this order.
enum Mode : std::uint8_t { kSurface = 0, kPaper = 1 };
inline constexpr std::array<const char*, 2> kModeNames = {"surface", "paper"};

/// Named values in the order of addition.
class Scores {
 public:
  void set(const std::string& name, double value) { values_.emplace_back(name, value); }
  /// Value with this name; NaN if there is none.
  [[nodiscard]] double get(const std::string& name) const;
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& all() const { return values_; }

 private:
  std::vector<std::pair<std::string, double>> values_;
};

struct ShapeResult {
  std::string name;
  std::string title;
  std::array<Scores, 2> modes;
};

/// A row of the paper's Table 1, and the values measured here.
struct DetectionRow {
  double separation_m = 0.0;
  bool dynamic = false;
  double paper_accuracy = 0.0;  ///< as printed in the paper, 0 .. 1; 0: the paper lacks this row
  int paper_false_positives = 0;
  int paper_false_negatives = 0;
  struct Count {
    int probes = 0;
    int false_positives = 0;
    int false_negatives = 0;
    [[nodiscard]] double accuracy() const {
      return 1.0 - static_cast<double>(false_positives + false_negatives) / probes;
    }
  };
  std::array<Count, 2> tracing;   ///< every probe on the surface
  std::array<Count, 2> hovering;  ///< 23.5 % on the surface, the others 2 to 10 mm above it
};

/// Table 2 of the paper: errors of distances, against a brute-force search.
struct DistanceTable {
  double literal_without_point = 0.0;  ///< fraction of the probes without a leaf in reach
  double paper_mean_m = 0.0;           ///< with the detection octant remembered
  double paper_max_m = 0.0;
  double surface_mean_m = 0.0;  ///< distance to the proxy against that to the true surface
  double surface_max_m = 0.0;
  double nearest_max_m = 0.0;  ///< the exact query against brute force, within its reach
};

struct LoopResult {
  std::array<double, 2> vibration_m_s2{};  ///< above 20 Hz, rms
  struct Stiffness {
    double rate_hz = 0.0;
    double expected_N_m = 0.0;  ///< (b + b_hand) / (T / 2 + t_d)
    std::array<double, 2> max_N_m{};
  };
  std::vector<Stiffness> stiffness;
  /// Stability limit of the controller's velocity estimate, damping and passivity control at a
  /// wall.
  struct Limit {
    double rate_hz = 0.0;
    double delay_s = 0.0;
    double hand_Ns_m = 0.0;
    double wall_Ns_m = 0.0;
    double formula_N_m = 0.0;   ///< core::stability_limit()
    double measured_N_m = 0.0;  ///< passivity control off
    double passive_N_m = 0.0;   ///< passivity control on, default configuration
  };
  std::vector<Limit> limits;
};

/// Forces of a hand that slides over a scan at a constant depth, and contact where it crosses it.
struct SlideScores {
  int slides = 0;
  int ticks = 0;
  int lost = 0;             ///< ticks without contact
  double expected_N = 0.0;  ///< stiffness times depth
  double force_error_rms_N = 0.0;
  double force_max_N = 0.0;
  /// Change between two ticks, less the change that is due to the movement of the hand: the
  /// maximum, and what 99 % and 99.9 % of the ticks do not exceed.
  double force_step_N = 0.0;
  double force_step_99_N = 0.0;
  double force_step_999_N = 0.0;
  int crossings = 0;  ///< straight through the surface, at 0.1, 0.5 and 1 m/s
  int late = 0;       ///< of these: contact not within 1 mm behind the surface, but two ticks later
  int missed = 0;     ///< of these: no contact
};

struct ScanResult {
  std::string name;
  std::string error;  ///< reason why the scan was not evaluated; empty if it was
  std::uint64_t input_points = 0;
  std::uint64_t kept_points = 0;                 ///< after cleaning
  std::map<std::string, std::uint64_t> dropped;  ///< cause -> count
  std::uint64_t points = 0;                      ///< of the model
  bool orientation_checked = false;
  double orientation_confidence = 0.0;
  std::uint64_t doubtful_points = 0;
  std::size_t pieces = 0;
  SlideScores slides;
  std::vector<std::string> notes;     ///< of the build
  std::vector<std::string> warnings;  ///< of the build
  double spacing_m = 0.0;
  double bridged_m = 0.0;                  ///< maximum width that the surface fit bridges
  std::vector<builder::Opening> openings;  ///< wider than bridged_m, in descending order of width;
                                           ///< in the frame of the file, m
  std::string hole_map;                    ///< SVG picture of the openings
  Scores scores;
};

/// Contact of a hand at an edge. The hand presses into a concave edge and slides along it, or it
/// slides along a ridge and across it. Each value is the worst of several turns of the body, rates
/// and speeds.
struct CreaseResult {
  std::string name;
  bool rests = true;  ///< in the crease for a while: off_m is measured
  bool noisy = false;
  int ticks = 0;
  int lost = 0;         ///< ticks in which contact was lost deeper than an encoder count (20 um)
  double late_m = 0.0;  ///< maximum depth reached before contact began, except fast_late_m
  double fast_late_m = 0.0;  ///< likewise at 4 kHz and 0.5 m/s
  double off_m = 0.0;        ///< distance of the proxy from the crease of a resting hand
  /// Maximum change of the force between two ticks in contact, less the change that is due to the
  /// movement of the hand; not at 0.5 m/s.
  double step_N = 0.0;
};

/// Hands that start anywhere inside a body, leave it on a straight line, and return.
struct InsideResult {
  std::string name;
  int starts = 0;
  int shown = 0;         ///< starts that are reported as inside before the hand moves
  double force_N = 0.0;  ///< maximum until the hand is 1 mm outside
  int felt = 0;          ///< starts with contact when the hand returns
};

/// A value with its required range.
struct Target {
  std::string name;
  double value = 0.0;
  double low = 0.0;  ///< met: low <= value <= high
  double high = 0.0;
  std::string unit;
  [[nodiscard]] bool met() const { return value >= low && value <= high; }
};

/// Force along one slide, for a plot.
struct ForceTrace {
  std::string title;
  std::vector<double> distance_m;
  std::array<std::vector<double>, 2> force_N;  ///< magnitude, per mode
};

struct Result {
  Options options;
  std::vector<DetectionRow> detection;
  DistanceTable distances;
  std::vector<ShapeResult> shapes;
  std::vector<CreaseResult> creases;
  std::vector<CreaseResult> stairs;
  std::vector<CreaseResult> corners;  ///< inside of a room, outside of a cube
  std::vector<CreaseResult> unions;   ///< two bodies that form one surface
  std::vector<InsideResult> inside;
  LoopResult loop;
  std::vector<ScanResult> scans;
  std::vector<Target> targets;
  ForceTrace trace;
  [[nodiscard]] bool all_met() const;
};

/// Cost: minutes on one core, or seconds with Options::quick; plus the scans.
[[nodiscard]] Result evaluate(const Options& options, builder::Progress& progress);

/// The result as JSON: tables, shapes, loop, scans, targets.
[[nodiscard]] std::string to_json(const Result& result);

/// The result as Markdown with the pictures of plots() in `picture_folder`; without pictures if
/// that is empty.
[[nodiscard]] std::string to_markdown(const Result& result, const std::string& picture_folder);

/// SVG pictures by file name.
[[nodiscard]] std::map<std::string, std::string> plots(const Result& result);

/// A section of Markdown per scan with its openings and the pictures of hole_maps().
[[nodiscard]] std::string holes_markdown(const Result& result);
/// SVG pictures by file name.
[[nodiscard]] std::map<std::string, std::string> hole_maps(const Result& result);

/// SVG picture of the maximum stable stiffness of a wall without a hand over the damping of the
/// wall, at several rates, as measured in simulation and as predicted by core::stability_limit().
/// Cost: seconds; `quick` omits rates.
[[nodiscard]] std::string z_width_svg(bool quick);
}  // namespace tactree::evaluation
