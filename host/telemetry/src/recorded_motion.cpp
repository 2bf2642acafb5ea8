#include "tactree/telemetry/recorded_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>

#include "tactree/core/control/state_machine.hpp"
#include "tactree/support/csv.hpp"
#include "tactree/support/user_error.hpp"
#include "tactree/telemetry/npz_reader.hpp"

namespace tactree::telemetry {
namespace {

constexpr std::size_t kMaxRows = 36'000'000;  // an hour at 10 kHz
constexpr const char* kColumns[] = {"t_s", "probe_x_m", "probe_y_m", "probe_z_m"};
constexpr std::size_t kColumnCount = std::size(kColumns);
// Optional.
constexpr const char* kState = "state";
constexpr const char* kContact = "in_contact";
constexpr const char* kOther = "give a file of tactree record or of simulate --trace";

using Row = std::array<double, kColumnCount>;

RecordedTick tick_of(const Row& row, bool in_contact) {
  return {row[0], {row[1], row[2], row[3]}, in_contact};
}

bool is_active(std::string_view state) { return state == core::name_of(core::State::kActive); }

std::vector<RecordedTick> read_table(const std::filesystem::path& file) {
  support::CsvReader table(file, {.header = support::CsvHeader::kRequired});
  std::array<std::size_t, kColumnCount> columns{};
  for (std::size_t k = 0; k < kColumnCount; ++k) {
    const auto column = table.find_column(kColumns[k]);
    if (!column) {
      table.refuse(fmt::format("the header has no column {}", kColumns[k]), kOther);
    }
    columns[k] = *column;
  }
  const auto state = table.find_column(kState);
  const auto contact = table.find_column(kContact);
  std::vector<RecordedTick> ticks;
  while (table.next_row()) {
    if (state && !is_active(table.cells()[*state])) {
      continue;
    }
    Row row{};
    for (std::size_t k = 0; k < kColumnCount; ++k) {
      row[k] = table.number(columns[k]);
    }
    if (!ticks.empty() && !(row[0] > ticks.back().t_s)) {
      table.refuse("t_s does not increase", kOther);
    }
    if (ticks.size() == kMaxRows) {
      table.refuse(fmt::format("more than {} ticks", kMaxRows), "record one tick of ten");
    }
    ticks.push_back(tick_of(row, contact && table.number(*contact) != 0.0));
  }
  return ticks;
}

/// The values of a column, as many as there are rows.
std::vector<double> values_of_rows(const NpzReader& archive, const char* column, std::size_t rows) {
  std::vector<double> values = archive.values(column);
  if (values.size() != rows) {
    archive.refuse(column, fmt::format("{} values instead of {}", values.size(), rows));
  }
  return values;
}

/// For each row, whether the state is active.
std::vector<bool> active_rows(const NpzReader& archive, std::size_t rows) {
  std::vector<bool> active(rows, true);
  if (archive.has(kState)) {
    const std::vector<std::string> words = archive.words(kState);
    const std::vector<double> states = values_of_rows(archive, kState, rows);
    for (std::size_t i = 0; i < rows; ++i) {
      const bool known = states[i] >= 0.0 && states[i] < static_cast<double>(words.size());
      active[i] = known && is_active(words[static_cast<std::size_t>(states[i])]);
    }
  }
  return active;
}

std::vector<RecordedTick> read_archive(const std::filesystem::path& file) {
  const NpzReader archive(file, kMaxRows);
  const std::size_t rows = archive.values(kColumns[0]).size();
  std::array<std::vector<double>, kColumnCount> columns;
  for (std::size_t k = 0; k < kColumnCount; ++k) {
    columns[k] = values_of_rows(archive, kColumns[k], rows);
  }
  const std::vector<bool> active = active_rows(archive, rows);
  const std::vector<double> contact = archive.has(kContact)
                                          ? values_of_rows(archive, kContact, rows)
                                          : std::vector<double>(rows, 0.0);
  std::vector<RecordedTick> ticks;
  for (std::size_t i = 0; i < rows; ++i) {
    if (!active[i]) {
      continue;
    }
    Row row{};
    for (std::size_t k = 0; k < kColumnCount; ++k) {
      row[k] = columns[k][i];
      if (!std::isfinite(row[k])) {
        archive.refuse(kColumns[k], fmt::format("row {} is not finite", i));
      }
    }
    if (!ticks.empty() && !(row[0] > ticks.back().t_s)) {
      archive.refuse("t_s", fmt::format("row {} is not later than the preceding one", i), kOther);
    }
    ticks.push_back(tick_of(row, contact[i] != 0.0));
  }
  return ticks;
}

/// Drops the ticks before the first one without contact, if there is one.
void begin_without_contact(std::vector<RecordedTick>& ticks) {
  const auto first = std::find_if(ticks.begin(), ticks.end(),
                                  [](const RecordedTick& tick) { return !tick.in_contact; });
  if (first != ticks.end()) {
    ticks.erase(ticks.begin(), first);
  }
}

}  // namespace

bool is_recording(const std::filesystem::path& file) {
  if (file.extension() == ".npz") {
    return true;
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    return false;
  }
  std::ifstream in(file);
  std::string header;
  std::getline(in, header);
  return header.find(kColumns[1]) != std::string::npos;
}

std::vector<RecordedTick> read_recorded_motion(const std::filesystem::path& file) {
  std::vector<RecordedTick> ticks =
      file.extension() == ".npz" ? read_archive(file) : read_table(file);
  if (ticks.empty()) {
    support::refuse(file.string(),
                    "no tick is in the state active, in which the hand feels the model",
                    "arm the board while it is recorded: record --arm");
  }
  begin_without_contact(ticks);
  const double begin_s = ticks.front().t_s;
  for (RecordedTick& tick : ticks) {
    tick.t_s -= begin_s;
  }
  return ticks;
}

}  // namespace tactree::telemetry
