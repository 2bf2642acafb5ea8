#include "scan/fit_option.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>

#include "tactree/setup/session.hpp"

namespace tactree::cli {
namespace {

constexpr char kDevice[] = "device";

}  // namespace

void set_fit(const std::string& text, builder::BuildOptions& build) {
  if (text == kDevice) {
    build.fit_edge_m = setup::fit_to_device("premium");
    return;
  }
  if (text.starts_with(std::string(kDevice) + ":")) {
    build.fit_edge_m = setup::fit_to_device(text.substr(sizeof kDevice));
    return;
  }
  double length_m = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), length_m);
  if (error != std::errc{} || rest != text.data() + text.size() || !std::isfinite(length_m) ||
      !(length_m > 0.0)) {
    throw CLI::ValidationError(
        "--fit", fmt::format("'{}' is neither a length in metres nor device:NAME", text));
  }
  build.fit_m = length_m;
}

}  // namespace tactree::cli
