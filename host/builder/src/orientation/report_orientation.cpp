#include "orientation/report_orientation.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace tactree::builder {
namespace {

// A warning for stray fragments would hide those that matter.
constexpr double kNoteworthy = 0.01;
constexpr const char* kSheetRemedy =
    "give --viewpoint X,Y,Z, --orient up, --flip-normals, or its thickness in metres with "
    "--two-sided";

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
      fmt::format("the outside of {:.0f} % of the surface is doubtful: {} (look at --preview; {})",
                  100.0 * share,
                  sheet ? fmt::format("it is {}", describe(worst->basis))
                        : "it is too thin or too noisy for its spacing",
                  sheet ? kSheetRemedy
                        : "scan more finely, give --viewpoint X,Y,Z of the scanner, or, if it is a "
                          "sheet, its thickness in metres with --two-sided"));
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
  warn_of_doubt(to, all, report);
  if (reversed_normals > 0) {
    report.warnings.push_back(
        fmt::format("{} normals of the file pointed inside and were reversed (--orient given keeps "
                    "them)",
                    reversed_normals));
  }
}

void report_windings(const WindingRepair& repair, std::uint64_t faces, BuildReport& report) {
  report.orientation.reversed_faces = repair.reversed_faces;
  if (repair.reversed_faces > 0) {
    report.warnings.push_back(
        fmt::format("{} of {} faces were wound inside out and were reversed (--orient given keeps "
                    "them)",
                    repair.reversed_faces, faces));
  }
  if (repair.undecided_share >= kNoteworthy) {
    report.warnings.push_back(fmt::format(
        "the outside of {:.0f} % of the faces is doubtful: they are open sheets with the side of "
        "their windings (look at --preview; {})",
        100.0 * repair.undecided_share, kSheetRemedy));
  }
}

}  // namespace tactree::builder
