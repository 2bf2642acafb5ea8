#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <iterator>

#include "measurements.hpp"
#include "scan_report.hpp"
#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {
namespace {

/// A page of Markdown under construction.
class Page {
 public:
  template <class... Values>
  void add(fmt::format_string<Values...> form, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), form, std::forward<Values>(values)...);
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string figure(double value, double scale = 1.0) {
  return std::isfinite(value) ? fmt::format("{:.3g}", scale * value + 0.0) : "-";
}

std::string count(double value) {
  return std::isfinite(value) ? fmt::format("{:.0f}", value) : "-";
}

std::string percent(double share) {
  return std::isfinite(share) ? fmt::format("{:.1f} %", 100.0 * share) : "-";
}

void add_picture(Page& page, const std::string& folder, const char* file, const char* title) {
  if (!folder.empty()) {
    page.add("![{}]({}/{})\n\n", title, folder, file);
  }
}

std::string detection(const DetectionRow::Count& c) {
  return fmt::format("{:.2f} % ({} / {})", 100.0 * c.accuracy(), c.false_positives,
                     c.false_negatives);
}

void add_detection(Page& page, const Result& result) {
  page.add(
      "## Table 1 of the paper: contact detection\n"
      "6 820 probes on z = cos x + cos y, |x|, |y| <= 0.25 m; box and six-point offset 2.5 mm as "
      "in "
      "the paper.\nAccuracy (false positives / false negatives). *Tracing*: all probes on the "
      "surface. *Hovering*: 23.5 % on the surface, the others\n2 to 10 mm above. Surface mode "
      "detects contact within the paper's margin of 5 um plus one step of the blob's lattice.\n\n"
      "| separation | model | printed in the paper | paper mode, tracing | paper mode, hovering | "
      "surface mode, tracing | surface mode, hovering |\n|---|---|---|---|---|---|---|\n");
  for (const DetectionRow& row : result.detection) {
    const std::string printed =
        row.paper_accuracy > 0.0 ? fmt::format("{:.2f} % ({} / {})", 100.0 * row.paper_accuracy,
                                               row.paper_false_positives, row.paper_false_negatives)
                                 : "-";
    page.add("| {:.4g} m | {} | {} | {} | {} | {} | {} |\n", row.separation_m,
             row.dynamic ? "dynamic" : "static", printed, detection(row.tracing[kPaper]),
             detection(row.hovering[kPaper]), detection(row.tracing[kSurface]),
             detection(row.hovering[kSurface]));
  }
  page.add(
      "\n**No row is reproduced exactly.** Row 0.0025, static, comes closest; nearly all of its "
      "misses are diagonal leaves, out of reach\nof the six points. Rows 0.01 and 0.005 do not "
      "follow from the same path: with boxes of 2.5 mm, most of a surface sampled at\n5 or 10 mm "
      "is in no box. A path with 23.5 % of its probes on the surface comes close to row 0.01, but "
      "not to row 0.0025. The\nfalse positives of rows 0.01 and 0.005 do not occur with boxes of "
      "2.5 mm. A rigid pose of the model changes results by\nrounding only; the paper's 98.18 % "
      "for the dynamic model does not match (3 + 179) of 6 820 either, which is 97.33 %.\n\n");
}

void add_distances(Page& page, const Result& result) {
  const DistanceTable& d = result.distances;
  page.add(
      "## Table 2 of the paper: distance to the surface\n"
      "Probes from 50 mm below to 10 mm above the sheet, h = 2.5 mm; difference of the distance "
      "from brute force.\n"
      "\n"
      "| | mean | max |\n"
      "|---|---|---|\n"
      "| printed in the paper | 1.97 um | 34.2 um |\n"
      "| paper mode, detection octant remembered, flat top | {} um | {} um |\n"
      "| exact nearest point, within reach | - | {} um |\n"
      "| surface mode, proxy, against the true surface | {} um | {} um |\n"
      "\n",
      figure(d.paper_mean_m, 1e6), figure(d.paper_max_m, 1e6), figure(d.nearest_max_m, 1e6),
      figure(d.surface_mean_m, 1e6), figure(d.surface_max_m, 1e6));
  page.add(
      "**Not reproduced.** As described in the paper, the experiment leaves {} of the probes "
      "without "
      "any point: neither the\nprobe nor its six points are in a leaf with points. It requires the "
      "octant of the detection to be remembered, and the\nflat top of the sheet, |x|, |y| <= 75 "
      "mm. The text's \"0.3 micrometre\" is 34 um in its table, and its \"25 mm\" is 2.5 mm. "
      "The\nrun times of both tables are from a different machine and are not compared here.\n\n",
      percent(d.literal_without_point));
}

void add_geometry(Page& page, const Result& result, const std::string& pictures) {
  page.add(
      "## Accuracy of the surface\n"
      "h = 1 mm unless stated otherwise; probes up to h above and below. *Off the surface*: "
      "distance of the computed point (rms /\n"
      "max); *distance*: error of the computed distance, rms; *normal*: error, rms; *answered*: "
      "percentage of probes with a result.\n"
      "Paper mode returns points of the cloud, which are on the surface but not necessarily the "
      "nearest.\n"
      "\n"
      "| shape | mode | off the surface, um | distance, um | normal, deg | answered |\n"
      "|---|---|---|---|---|---|\n");
  for (const ShapeResult& shape : result.shapes) {
    for (const Mode mode : {kSurface, kPaper}) {
      const Scores& s = shape.modes[mode];
      page.add("| {} | {} | {} / {} | {} | {} | {} |\n", shape.title, kModeNames[mode],
               figure(s.get("distance_rms_m"), 1e6), figure(s.get("distance_max_m"), 1e6),
               figure(s.get("depth_rms_m"), 1e6), figure(s.get("normal_rms_deg")),
               percent(s.get("answered")));
    }
  }
  page.add("\n");
  add_picture(page, pictures, "depth.svg", "Error of the distance");
  add_picture(page, pictures, "normal.svg", "Error of the normal");
}

void add_forces(Page& page, const Result& result, const std::string& pictures) {
  page.add(
      "## Contact force\n"
      "Sliding 1 mm deep at 0.1 m/s, 1 N/mm, 1 kHz, without friction: error of the force of 1 N, "
      "largest step between ticks\n"
      "(0.0033 N are due to the turning of the force on the sphere), ticks without contact. "
      "*Pulled in*: percentage of probes 1 mm\n"
      "outside with a force towards the surface. *Missed*: undetected crossings of the surface at "
      "0.05 to 6 m/s and up to 60 degrees\n"
      "from the normal. *Friction*: ratio of tangential to normal force while slipping; "
      "coefficient 0.3.\n"
      "\n"
      "| shape | mode | error, N rms | step, N | lost, of ticks | pulled in | missed, of | "
      "friction |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const ShapeResult& shape : result.shapes) {
    for (const Mode mode : {kSurface, kPaper}) {
      const Scores& s = shape.modes[mode];
      const bool friction = std::isfinite(s.get("friction_min"));
      page.add(
          "| {} | {} | {} | {} | {} of {} | {} | {} of {} | {} |\n", shape.title, kModeNames[mode],
          figure(s.get("force_error_rms_N")), figure(s.get("force_step_max_N")),
          count(s.get("contact_lost")), count(s.get("slide_ticks")), percent(s.get("sticky")),
          count(s.get("crossings_missed")), count(s.get("crossings")),
          friction ? fmt::format("{:.3f} .. {:.3f}", s.get("friction_min"), s.get("friction_max"))
                   : "-");
    }
  }
  page.add(
      "\nIn paper mode at h = 1 mm the boxes are 0.5 mm deep: no contact 1 mm below the surface, "
      "hence no step. In a hole of a\nthinned cloud without any point in the support, contact ends "
      "as at a boundary.\n\n");
  add_picture(page, pictures, "force.svg", "Force while sliding");
  add_picture(page, pictures, "force_error.svg", "Error of the force");
}

void add_crease_table(Page& page, const char* name,
                      std::initializer_list<const std::vector<CreaseResult>*> results) {
  page.add(
      "| {} | lost, of ticks | noticed at, mm | at 0.5 m/s | off, um | step, N |\n"
      "|---|---|---|---|---|---|\n",
      name);
  for (const std::vector<CreaseResult>* rows : results) {
    for (const CreaseResult& row : *rows) {
      page.add("| {} | {} of {} | {} | {} | {} | {} |\n", row.name, row.lost, row.ticks,
               figure(row.late_m, 1e3), figure(row.fast_late_m, 1e3),
               row.rests ? figure(row.off_m, 1e6) : "-", figure(row.step_N));
    }
  }
  page.add("\n");
}

void add_creases(Page& page, const Result& result) {
  page.add(
      "## Creases\n"
      "Edges of exact bodies, each in {} orientations, all but one arbitrary. Grooves: the hand "
      "presses 4 mm beyond the bottom,\n"
      "stays, slides along and aside.\n"
      "Ridges: it slides along and across, 0.6 mm below the top. 1 N/mm, no friction; the worst of "
      "1 kHz at 0.02 and 0.1 m/s,\n"
      "2 kHz at 0.1 m/s, 4 kHz at 0.1 and 0.5 m/s. *Lost*: ticks without contact while the hand is "
      "deeper than an encoder\n"
      "count (20 um). *Noticed at*: depth at which contact began. *Off*: distance of the proxy "
      "from the bottom line.\n"
      "*Step*: of the force between two ticks in contact, also while the proxy falls from one face "
      "to another, beyond the\n"
      "hand's own movement, excluding the runs at 0.5 m/s.\n"
      "\n",
      crease_turns(result.options.quick));
  add_crease_table(page, "crease", {&result.creases});
}

void add_courses(Page& page, const Result& result) {
  page.add(
      "## Stairs, rooms and bodies together\n"
      "Likewise, with stairs (pressed into the foot of a riser, along it, over the edge), the "
      "inside of a cube of 20 mm\n"
      "(into an edge and a corner, 2 mm beyond the walls), the outside of a cube (over its edges "
      "and a corner), and two\n"
      "bodies whose union is the surface. *Off*: distance of the proxy from the foot, the corner "
      "or the surface of the union.\n"
      "\n");
  add_crease_table(page, "surface", {&result.stairs, &result.corners, &result.unions});
}

void add_inside(Page& page, const Result& result) {
  page.add(
      "## Starts inside\n"
      "Hands that are inside a body when the force begins: at random positions, out on straight "
      "lines in random directions, and\n"
      "back; 1, 2 and 4 kHz, 0.1 and 0.8 m/s. *Shown*: as inside, before the hand moves. *Force*: "
      "the largest until the hand\n"
      "is 1 mm outside. *Felt*: the body, when the hand returns.\n"
      "\n"
      "| body | starts | shown | force, N | felt |\n"
      "|---|---|---|---|---|\n");
  for (const InsideResult& row : result.inside) {
    page.add("| {} | {} | {} | {} | {} |\n", row.name, row.starts, row.shown, figure(row.force_N),
             row.felt);
  }
  page.add("\n");
}

void add_loop(Page& page, const Result& result) {
  page.add(
      "## The closed loop\n"
      "*Vibration*: acceleration of the tip above 20 Hz, rms, while a hand presses with 1 N and "
      "moves at 10 mm/s over the\ncosine sheet, h = 2.5 mm: 1 kHz, 1 N/mm, encoder 20 um. "
      "*Stiffness*: largest stable stiffness of a device with\nb = 0.5 Ns/m, no hand, no delay; "
      "2 b / T is Colgate and Brown's limit.\n\n| | surface | paper | 2 b / T "
      "|\n|---|---|---|---|\n");
  const LoopResult& loop = result.loop;
  page.add("| vibration, m/s2 | {} | {} | - |\n", figure(loop.vibration_m_s2[kSurface]),
           figure(loop.vibration_m_s2[kPaper]));
  for (const LoopResult::Stiffness& row : loop.stiffness) {
    page.add("| stiffness at {:.0f} kHz, N/mm | {} | {} | {} |\n", 1e-3 * row.rate_hz,
             figure(row.max_N_m[kSurface], 1e-3), figure(row.max_N_m[kPaper], 1e-3),
             figure(row.expected_N_m, 1e-3));
  }
  page.add(
      "\nStability limits of the controller by rate, delay from reading to force, damping of the "
      "hand and of the wall:\n*formula* is the limit applied to configurations, *measured* is "
      "without passivity control, *passive* with it. The cutoff\nof the velocity filter is 200 Hz, "
      "from 4 kHz on a twentieth of the rate: the wall's damping acts in full only if the\nfilter "
      "is faster than the oscillation of the wall.\n\n"
      "| rate, kHz | delay, ms | hand, Ns/m | wall, Ns/m | formula, N/mm | measured | passive | "
      "gain |\n|---|---|---|---|---|---|---|---|\n");
  for (const LoopResult::Limit& c : loop.limits) {
    page.add("| {:.0f} | {:.1f} | {:.1f} | {:.1f} | {} | {} | {} | {} |\n", 1e-3 * c.rate_hz,
             1e3 * c.delay_s, c.hand_Ns_m, c.wall_Ns_m, figure(c.formula_N_m, 1e-3),
             figure(c.measured_N_m, 1e-3), figure(c.passive_N_m, 1e-3),
             figure(c.passive_N_m / c.measured_N_m));
  }
  page.add("\n");
}

void add_slides(Page& page, const std::vector<ScanResult>& scans) {
  page.add(
      "A hand slides over each model in random directions, without friction, at 1 kHz, at a depth "
      "of 1 mm or a spacing if that is\n"
      "less; it also crosses the surface, at 0.1, 0.5 and 1 m/s. *Lost*: ticks of the slides "
      "without contact: at edges of sheets and\n"
      "holes, and where a part is thinner than the depth. *Step*: change of the force between two "
      "ticks, less the change that is\n"
      "due to the movement of the hand. *Late*: crossings noticed deeper than 1 mm, in one of the "
      "next two ticks.\n*Missed*: the others.\n"
      "\n"
      "| model | ticks | lost | force, N | step, N, 99 % | 99.9 % | largest | crossings | late | "
      "missed |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const ScanResult& scan : scans) {
    if (scan.error.empty()) {
      const SlideScores& s = scan.slides;
      page.add("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", scan.name, s.ticks, s.lost,
               figure(s.expected_N), figure(s.force_step_99_N), figure(s.force_step_999_N),
               figure(s.force_step_N), s.crossings, s.late, s.missed);
    }
  }
  page.add("\n");
}

void add_scans(Page& page, const Result& result) {
  if (result.scans.empty()) {
    return;
  }
  page.add(
      "## Real models\n"
      "Built with a longest edge of {:g} mm, and compared with a double precision APSS over all "
      "decoded points, projected until\n"
      "convergence; probes within a spacing of the surface; lengths in thousandths of the spacing "
      "h. *Smooth*: no two normals in\n"
      "the support differ by more than 47 degrees. Elsewhere surface mode preserves edges that the "
      "reference rounds.\n"
      "\n"
      "| model | points | smooth | point, rms / max | normal, deg rms | all: point, rms / max | "
      "normal, deg rms | answered |\n"
      "|---|---|---|---|---|---|---|---|\n",
      1e3 * kModelEdge_m);
  for (const ScanResult& scan : result.scans) {
    if (!scan.error.empty()) {
      page.add("| {} | not evaluated: {} | | | | | | |\n", scan.name, scan.error);
      continue;
    }
    const Scores& s = scan.scores;
    const double scale = 1e3 / scan.spacing_m;
    page.add("| {} | {} | {} | {} / {} | {} | {} / {} | {} | {} |\n", scan.name, scan.points,
             percent(1.0 - s.get("creased")), figure(s.get("smooth_distance_rms_m"), scale),
             figure(s.get("smooth_distance_max_m"), scale), figure(s.get("smooth_normal_rms_deg")),
             figure(s.get("distance_rms_m"), scale), figure(s.get("distance_max_m"), scale),
             figure(s.get("normal_rms_deg")), percent(s.get("answered")));
  }
  page.add("\n");
  add_slides(page, result.scans);
}

std::string bounds_of(const Target& target) {
  return target.low > 0.0 ? fmt::format("{:.4g} .. {:.4g} {}", target.low, target.high, target.unit)
                          : fmt::format("<= {:.3g} {}", target.high, target.unit);
}

void add_targets(Page& page, const Result& result) {
  page.add("## Targets of surface mode\n\n| target | required | measured | |\n|---|---|---|---|\n");
  for (const Target& target : result.targets) {
    page.add("| {} | {} | {:.4g} | {} |\n", target.name, bounds_of(target), target.value,
             target.met() ? "met" : "**missed**");
  }
  page.add("\n{}\n", result.all_met() ? "All targets are met." : "Not all targets are met.");
}

}  // namespace

std::string to_markdown(const Result& result, const std::string& pictures) {
  if (result.options.scans_only) {
    return scan_report(result);
  }
  Page page;
  page.add(
      "# Evaluation results\n\nAll values come from `tactree evaluate`{}, seed {}, and are "
      "reproducible.\n*Surface* is the default mode, *paper* the unmodified method of El-Far, "
      "Georganas and El Saddik.\n\n",
      result.options.quick ? " --quick" : "", result.options.seed);
  add_detection(page, result);
  add_distances(page, result);
  add_geometry(page, result, pictures);
  add_forces(page, result, pictures);
  add_creases(page, result);
  add_courses(page, result);
  add_inside(page, result);
  add_loop(page, result);
  add_scans(page, result);
  add_targets(page, result);
  return page.take();
}

}  // namespace tactree::evaluation
