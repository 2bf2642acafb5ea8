#include "normals/report_orientation.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace tactree::builder {
namespace {

// Ratio of the surface below which nothing is reported, because a warning about stray fragments
// would hide those that matter.
constexpr double kNoteworthy = 0.01;
constexpr const char* kSheetRemedy =
    "give --viewpoint X,Y,Z, --orient up, --flip-normals, or its thickness in metres with "
    "--two-sided";

/// Number of points of the components whose orientation the evidence `basis` decided.
double points_by(const OrientationReport& orientation, OrientationBasis basis) {
  double points = 0.0;
  for (const OrientedPiece& piece : orientation.pieces) {
    points += piece.basis == basis ? piece.points : 0;
  }
  return points;
}

// A scanner position in the file is named as the cause only if it decided the orientation, so that
// the note does not contradict the result.
void note_scanners(const OrientationReport& orientation, double all, BuildReport& report) {
  const std::size_t count = orientation.scanners.size();
  if (count == 0) {
    return;
  }
  const Eigen::Vector3d& p = orientation.scanners.front();
  const std::string place = fmt::format(
      "({:.6g}, {:.6g}, {:.6g}){}", p.x(), p.y(), p.z(),
      count > 1 ? fmt::format(" and {} more position{}", count - 1, count > 2 ? "s" : "") : "");
  const double share = points_by(orientation, OrientationBasis::kViewpoint) / all;
  if (share < kNoteworthy) {
    report.notes.push_back(fmt::format(
        "the position of the scanner that the file states, {}, determines no orientation: {}",
        place, "no component of the surface clearly faces it"));
    return;
  }
  report.notes.push_back(
      fmt::format("{} faces the scanner at {}, as the file states (--orient outward ignores it)",
                  share > 1.0 - kNoteworthy ? "the surface"
                                            : fmt::format("{:.0f} % of the surface", 100.0 * share),
                  place));
}

// The hint does not request what is already known.
std::string remedy_for(OrientationBasis basis) {
  switch (basis) {
    case OrientationBasis::kUp:
    case OrientationBasis::kConvex:
      return kSheetRemedy;
    case OrientationBasis::kViewpoint:
      return "scan more finely, or, if it is a sheet, give its thickness in metres with "
             "--two-sided";
    default:
      return "scan more finely, give --viewpoint X,Y,Z of the scanner, or, if it is a sheet, its "
             "thickness in metres with --two-sided";
  }
}

void warn_of_doubt(const OrientationReport& orientation, double all, BuildReport& report) {
  const double share = static_cast<double>(orientation.doubtful_points) / all;
  if (share < kNoteworthy) {
    return;
  }
  const auto worst =
      std::find_if(orientation.pieces.begin(), orientation.pieces.end(),
                   [](const OrientedPiece& piece) { return piece.confidence < kLeastConfidence; });
  const bool sheet =
      worst->basis == OrientationBasis::kUp || worst->basis == OrientationBasis::kConvex;
  report.warnings.push_back(
      fmt::format("the orientation of {:.0f} % of the surface is ambiguous: {} (see --preview; {})",
                  100.0 * share,
                  sheet ? fmt::format("it is {}", describe(worst->basis))
                        : "it is too thin or too noisy for its spacing",
                  remedy_for(worst->basis)));
}

}  // namespace

void report_orientation(const CloudOrientation& orientation, std::uint64_t reversed_normals,
                        BuildReport& report) {
  OrientationReport& to = report.orientation;
  to.checked = true;
  to.pieces = orientation.pieces;
  to.reversed_normals = reversed_normals;
  double sum = 0.0;
  double all = 0.0;
  for (const OrientedPiece& piece : to.pieces) {
    sum += piece.confidence * piece.points;
    all += piece.points;
    to.doubtful_points += piece.confidence < kLeastConfidence ? piece.points : 0;
  }
  to.confidence = all > 0.0 ? sum / all : 1.0;
  note_scanners(to, all, report);
  warn_of_doubt(to, all, report);
  if (reversed_normals > 0) {
    report.warnings.push_back(fmt::format(
        "{} normals of the file pointed inwards and were reversed (--orient given keeps them)",
        reversed_normals));
  }
}

void report_windings(const WindingRepair& repair, std::uint64_t faces, BuildReport& report) {
  report.orientation.reversed_faces = repair.reversed_faces;
  if (repair.reversed_faces > 0) {
    report.warnings.push_back(fmt::format(
        "{} of {} faces had inward windings and were reversed (--orient given keeps them)",
        repair.reversed_faces, faces));
  }
  if (repair.undecided_share >= kNoteworthy) {
    report.warnings.push_back(
        fmt::format("the orientation of {:.0f} % of the faces is ambiguous: they form open sheets "
                    "and keep the orientation of their windings (see --preview; {})",
                    100.0 * repair.undecided_share, kSheetRemedy));
  }
}

}  // namespace tactree::builder
