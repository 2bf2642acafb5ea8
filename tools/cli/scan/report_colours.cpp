#include "scan/report_colours.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "tactree/support/user_error.hpp"

namespace tactree::cli {

std::vector<viewer::ScanColour> report_colours(const std::string& file) {
  if (file.empty()) {
    return {};
  }
  std::ifstream in(file, std::ios::binary);
  try {
    const nlohmann::json report = nlohmann::json::parse(in);
    std::vector<viewer::ScanColour> colours;
    for (const nlohmann::json& colour : report.at("colours")) {
      colours.push_back({colour.at("rgb").get<std::array<std::uint8_t, 3>>(),
                         colour.at("points").get<std::uint64_t>()});
    }
    if (colours.empty()) {
      support::refuse(file, "the scan of this report has no colours",
                      "build from a scan with colours, or omit --report");
    }
    return colours;
  } catch (const nlohmann::json::exception& error) {
    support::refuse(file, std::string("is not the report of a build: ") + error.what(),
                    "give the file that tactree build --report wrote");
  }
}

}  // namespace tactree::cli
