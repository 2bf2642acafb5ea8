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

struct Options {
  bool quick = false;      ///< fewer probes and lines: seconds instead of minutes, for tests
  std::uint32_t seed = 1;  ///< of the random numbers
  std::vector<std::filesystem::path> scans;
};

/// The two modes, in the order of every array below.
enum Mode : std::uint8_t { kSurface = 0, kPaper = 1 };
inline constexpr std::array<const char*, 2> kModeNames = {"surface", "paper"};

/// Named values in the order of addition.
class Scores {
 public:
  void set(const std::string& name, double value) { values_.emplace_back(name, value); }
  /// NaN if there is none.
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

/// A row of the paper's Table 1, and our measurement.
struct DetectionRow {
  double separation_m = 0.0;
  bool dynamic = false;
  double paper_accuracy = 0.0;  ///< as printed there, 0 .. 1
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

/// Table 2: distances found, against a brute-force search.
struct DistanceTable {
  double literal_without_point = 0.0;  ///< share of the probes without a leaf in reach
  double paper_mean_m = 0.0;           ///< with the detection octant remembered
  double paper_max_m = 0.0;
  double surface_mean_m = 0.0;  ///< the proxy's distance against that of the true surface
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
  /// The controller's own parts against a wall: velocity estimate, damping, passivity control.
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

struct ScanResult {
  std::string name;
  std::string error;  ///< not empty: the scan was not evaluated for this reason
  std::uint64_t points = 0;
  double spacing_m = 0.0;
  double support_m = 0.0;                  ///< largest radius that the surface fit bridges
  std::vector<builder::Opening> openings;  ///< wider than that, widest first
  std::string hole_map;                    ///< SVG picture of the openings
  Scores scores;
};

/// A hand at an edge: concave ones pressed 4 mm deep and slid along, ridges slid along and crossed;
/// the worst of several turns of the body, rates and speeds.
struct CreaseResult {
  std::string name;
  bool concave = true;
  bool noisy = false;
  int ticks = 0;
  int lost = 0;         ///< without contact, more than an encoder count (20 um) deep, after contact
  double late_m = 0.0;  ///< depth at which a contact began
  double fast_late_m = 0.0;  ///< the same at 4 kHz and 0.5 m/s
  double off_m = 0.0;        ///< concave: of the proxy from the crease, once the hand stays
  /// Of the force between two ticks in contact, beyond the hand's own movement; without the fast.
  double step_N = 0.0;
};

/// Hands that start anywhere inside a body, leave it on a straight line, and return.
struct InsideResult {
  std::string name;
  int starts = 0;
  int shown = 0;         ///< as inside, before the hand moves
  double force_N = 0.0;  ///< largest, until the hand is 1 mm outside
  int felt = 0;          ///< the body, when the hand returns
};

/// A required value.
struct Target {
  std::string name;
  double value = 0.0;
  double low = 0.0;  ///< met: low <= value <= high
  double high = 0.0;
  std::string unit;
  [[nodiscard]] bool met() const { return value >= low && value <= high; }
};

/// For a plot: force along one slide.
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
  std::vector<InsideResult> inside;
  LoopResult loop;
  std::vector<ScanResult> scans;
  std::vector<Target> targets;
  ForceTrace trace;
  [[nodiscard]] bool all_met() const;
};

/// Minutes on one core; seconds when quick, plus the scans.
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

/// An SVG picture: the largest stable stiffness of a wall without a hand, over its damping, at
/// several rates; measured in simulation, and predicted by core::stability_limit(). Cost: seconds;
/// `quick` omits rates.
[[nodiscard]] std::string z_width_svg(bool quick);
}  // namespace tactree::evaluation
