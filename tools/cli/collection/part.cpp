#include "collection/part.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

constexpr const char* kPartRemedy = "state the part with --part K/N";

/// A whole number without a sign.
std::optional<std::size_t> to_count(std::string_view text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_whole = error == std::errc{} && end == text.data() + text.size();
  return is_whole ? std::optional(value) : std::nullopt;
}

/// The value of an environment variable; `missing` if it is not set and has a default.
std::size_t count_of(const char* variable, std::optional<std::size_t> missing = std::nullopt) {
  const char* const text = std::getenv(variable);
  const std::optional<std::size_t> value = text == nullptr ? missing : to_count(text);
  if (!value) {
    support::refuse(
        variable, text == nullptr ? "is not set" : fmt::format("'{}' is not a whole number", text),
        kPartRemedy);
  }
  return *value;
}

/// `place` counts from 0.
CollectionPart part_at(std::size_t place, std::size_t count, const std::string& origin) {
  if (place >= count) {
    support::refuse(origin, "the number is not below the count", kPartRemedy);
  }
  return {place + 1, count, origin};
}

/// The indices of an array job may begin anywhere and have a step, as in --array=10-40:10.
std::optional<CollectionPart> slurm_part() {
  const char* const id = std::getenv("SLURM_ARRAY_TASK_ID");
  if (id == nullptr) {
    return std::nullopt;
  }
  const std::size_t index = count_of("SLURM_ARRAY_TASK_ID");
  const std::size_t count = count_of("SLURM_ARRAY_TASK_COUNT");
  const std::size_t first = count_of("SLURM_ARRAY_TASK_MIN", 0);
  const std::size_t step = std::max<std::size_t>(count_of("SLURM_ARRAY_TASK_STEP", 1), 1);
  const std::size_t last = count_of("SLURM_ARRAY_TASK_MAX", first + step * (count - 1));
  const std::string origin =
      fmt::format("SLURM_ARRAY_TASK_ID={}, SLURM_ARRAY_TASK_COUNT={}", index, count);
  if (count == 0 || index < first || (index - first) % step != 0 ||
      last != first + step * (count - 1)) {
    support::refuse(origin, "the indices of the array job are not evenly spaced",
                    "use an array such as --array=1-8, or --part K/N");
  }
  return part_at((index - first) / step, count, origin);
}

std::optional<CollectionPart> rank_part(const char* rank, const char* size) {
  if (std::getenv(rank) == nullptr) {
    return std::nullopt;
  }
  const std::size_t place = count_of(rank);
  const std::size_t count = count_of(size);
  return part_at(place, count, fmt::format("{}={}, {}={}", rank, place, size, count));
}

CollectionPart stated_part(const std::string& option) {
  const std::size_t slash = option.find('/');
  const std::string_view text = option;
  const std::optional<std::size_t> number = to_count(text.substr(0, slash));
  const std::optional<std::size_t> count =
      slash == std::string::npos ? std::nullopt : to_count(text.substr(slash + 1));
  if (!number || !count || *number < 1 || *number > *count) {
    throw CLI::ValidationError(
        "--part", fmt::format("'{}' is not of the form K/N with K from 1 to N", option));
  }
  return {*number, *count, "--part"};
}

}  // namespace

CollectionPart choose_part(const std::string& option) {
  if (!option.empty()) {
    return stated_part(option);
  }
  CollectionPart chosen;
  for (const std::optional<CollectionPart>& part :
       {slurm_part(), rank_part("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"),
        rank_part("PMI_RANK", "PMI_SIZE")}) {
    if (!part || part->count == 1) {
      continue;
    }
    if (chosen.count > 1) {
      support::refuse(chosen.origin + " and " + part->origin,
                      "two launchers state a part of the collection", kPartRemedy);
    }
    chosen = *part;
  }
  return chosen;
}

}  // namespace tactree::cli
