// Locates, reads and writes the costs of a tick in an image.
#include <fmt/core.h>

#include <cstdint>
#include <fstream>
#include <ios>
#include <optional>

#include "image.hpp"
#include "tactree/wcet/bound.hpp"
#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {
namespace {

constexpr const char* kCostsSymbol = "tactree_tick_costs";

std::optional<std::streamoff> costs_offset(const std::filesystem::path& image) {
  const std::optional<std::uint64_t> offset = Image(image).offset_of(kCostsSymbol);
  return offset ? std::optional(static_cast<std::streamoff>(*offset)) : std::nullopt;
}

[[noreturn]] void refuse_without_costs(const std::filesystem::path& image) {
  throw BoundError(
      fmt::format("{}: has no {} (link tactree::runtime and pass its tick_costs() to the "
                  "controller)",
                  image.string(), kCostsSymbol));
}

}  // namespace

void embed(const std::filesystem::path& image, const core::TickCosts& costs) {
  const std::optional<std::streamoff> offset = costs_offset(image);
  if (!offset) {
    refuse_without_costs(image);
  }
  std::fstream file(image, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(*offset);
  file.write(reinterpret_cast<const char*>(&costs), sizeof costs);
  if (!file.flush()) {
    throw BoundError(image.string() + ": cannot be written (check the file's permissions)");
  }
}

std::optional<core::TickCosts> find_embedded(const std::filesystem::path& image) {
  const std::optional<std::streamoff> offset = costs_offset(image);
  if (!offset) {
    return std::nullopt;
  }
  std::ifstream file(image, std::ios::binary);
  core::TickCosts costs;
  file.seekg(*offset);
  if (!file.read(reinterpret_cast<char*>(&costs), sizeof costs)) {
    throw BoundError(image.string() + ": cannot be read (it is truncated; build it again)");
  }
  return costs;
}

core::TickCosts embedded(const std::filesystem::path& image) {
  const std::optional<core::TickCosts> costs = find_embedded(image);
  if (!costs) {
    refuse_without_costs(image);
  }
  return *costs;
}

}  // namespace tactree::wcet
