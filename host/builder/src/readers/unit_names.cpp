#include "unit_names.hpp"

#include "number.hpp"

namespace tactree::builder {
namespace {

constexpr double kFoot = 0.3048;
constexpr double kSurveyFoot = 1200.0 / 3937.0;

struct Unit {
  std::string_view name;
  double metres;
};

constexpr Unit kUnits[] = {{"m", 1.0},
                           {"metre", 1.0},
                           {"metres", 1.0},
                           {"meter", 1.0},
                           {"meters", 1.0},
                           {"km", 1e3},
                           {"cm", 1e-2},
                           {"centimetre", 1e-2},
                           {"centimetres", 1e-2},
                           {"centimeter", 1e-2},
                           {"centimeters", 1e-2},
                           {"mm", 1e-3},
                           {"millimetre", 1e-3},
                           {"millimetres", 1e-3},
                           {"millimeter", 1e-3},
                           {"millimeters", 1e-3},
                           {"um", 1e-6},
                           {"micrometre", 1e-6},
                           {"micrometres", 1e-6},
                           {"micrometer", 1e-6},
                           {"micrometers", 1e-6},
                           {"micron", 1e-6},
                           {"microns", 1e-6},
                           {"in", 0.0254},
                           {"inch", 0.0254},
                           {"inches", 0.0254},
                           {"ft", kFoot},
                           {"foot", kFoot},
                           {"feet", kFoot},
                           {"international ft", kFoot},
                           {"international foot", kFoot},
                           {"international feet", kFoot},
                           {"ftus", kSurveyFoot},
                           {"usft", kSurveyFoot},
                           {"us-ft", kSurveyFoot},
                           {"us ft", kSurveyFoot},
                           {"us foot", kSurveyFoot},
                           {"us feet", kSurveyFoot},
                           {"survey ft", kSurveyFoot},
                           {"survey foot", kSurveyFoot},
                           {"survey feet", kSurveyFoot},
                           {"us survey ft", kSurveyFoot},
                           {"us survey foot", kSurveyFoot},
                           {"us survey feet", kSurveyFoot}};

}  // namespace

std::optional<double> metres_of_unit(std::string_view name) {
  for (const Unit& unit : kUnits) {
    if (equal_ignoring_case(unit.name, name)) return unit.metres;
  }
  return std::nullopt;
}

}  // namespace tactree::builder
