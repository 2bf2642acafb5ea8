#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "tactree/support/csv.hpp"
#include "tactree/telemetry/npz_reader.hpp"
#include "tactree/viewer/trace_playback.hpp"

namespace tactree::viewer {
namespace {

using simulation::Sample;

// Maximum length of a trace that `tactree simulate` writes.
constexpr std::size_t kMaxTicks = 5000000;
constexpr const char* kRemedy = "give a file written by simulate --trace or by tactree record";
constexpr const char* kShorter = "record a shorter run, or one tick of ten";
constexpr const char* kRequired[] = {"t_s",       "probe_x_m", "probe_y_m", "probe_z_m",
                                     "force_x_N", "force_y_N", "force_z_N"};

/// A member of a sample, and the column with its values.
struct Member {
  std::string column;
  std::function<void(Sample&, double)> set;
};

float& component(core::Vec3& v, std::size_t axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

std::uint32_t index_of(double value, std::uint32_t none) {
  const bool known = value >= 0.0 && value <= std::numeric_limits<std::uint32_t>::max();
  return known ? static_cast<std::uint32_t>(value) : none;
}

/// Appends the columns of a vector: NAME_xUNIT, NAME_yUNIT, NAME_zUNIT.
template <class Get>
void add_vector(std::vector<Member>& members, const char* name, const char* unit, Get get) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    members.push_back({fmt::format("{}_{}{}", name, "xyz"[axis], unit),
                       [get, axis](Sample& sample, double value) {
                         component(get(sample), axis) = static_cast<float>(value);
                       }});
  }
}

void add_vectors(std::vector<Member>& members) {
  using V = core::Vec3&;
  add_vector(members, "probe", "_m", [](Sample& s) -> V { return s.status.probe; });
  add_vector(members, "velocity", "_m_s", [](Sample& s) -> V { return s.status.velocity; });
  add_vector(members, "force", "_N", [](Sample& s) -> V { return s.status.force; });
  add_vector(members, "gravity_force", "_N", [](Sample& s) -> V { return s.status.gravity_force; });
  add_vector(members, "added_force", "_N", [](Sample& s) -> V { return s.status.added_force; });
  add_vector(members, "motor_force", "_N", [](Sample& s) -> V { return s.status.motor_force; });
  add_vector(members, "wanted_force", "_N",
             [](Sample& s) -> V { return s.status.rendering.force; });
  add_vector(members, "proxy", "_m", [](Sample& s) -> V { return s.status.rendering.proxy; });
  add_vector(members, "normal", "", [](Sample& s) -> V { return s.status.rendering.normal; });
  for (int axis = 0; axis < 3; ++axis) {
    members.push_back({fmt::format("tip_{}_m", "xyz"[axis]),
                       [axis](Sample& s, double value) { s.tip_m[axis] = value; }});
  }
}

/// All columns of numbers. The values of missing ones stay as they are.
std::vector<Member> all_members() {
  std::vector<Member> members;
  const auto add = [&](const char* column, std::function<void(Sample&, double)> set) {
    members.push_back({column, std::move(set)});
  };
  add("t_s", [](Sample& s, double value) { s.t_s = value; });
  add_vectors(members);
  add("limits", [](Sample& s, double value) { s.status.limits = index_of(value, 0); });
  add("faults", [](Sample& s, double value) { s.status.faults = index_of(value, 0); });
  add("in_contact", [](Sample& s, double value) { s.status.rendering.in_contact = value != 0.0; });
  add("slipping", [](Sample& s, double value) { s.status.rendering.slipping = value != 0.0; });
  add("penetration_m", [](Sample& s, double value) {
    s.status.rendering.penetration_m = static_cast<float>(value);
  });
  add("strength",
      [](Sample& s, double value) { s.status.rendering.strength = static_cast<float>(value); });
  add("body",
      [](Sample& s, double value) { s.status.rendering.body = index_of(value, core::kNoBody); });
  add("overruns", [](Sample& s, double value) { s.status.overruns = index_of(value, 0); });
  add("load", [](Sample& s, double value) { s.status.load = static_cast<float>(value); });
  return members;
}

bool is_float(double value) {
  return std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max());
}

core::State state_of(std::string_view name) {
  for (std::uint32_t i = 0; i < core::kStates; ++i) {
    if (name == core::name_of(static_cast<core::State>(i))) {
      return static_cast<core::State>(i);
    }
  }
  return core::State::kBoot;
}

/// Before its members are set. `has_parts`: the file has the forces of gravity and of the motors.
Sample blank_sample(bool has_parts) {
  Sample sample;
  sample.has_parts = has_parts;
  sample.status.state = core::State::kBoot;
  sample.status.rendering.body = core::kNoBody;
  return sample;
}

/// For boards, which do not report the true position of the tip.
void use_probe_as_tip(Sample& sample) {
  const core::Vec3& probe = sample.status.probe;
  sample.tip_m = {static_cast<double>(probe.x), static_cast<double>(probe.y),
                  static_cast<double>(probe.z)};
}

std::vector<Sample> read_csv(const std::filesystem::path& file) {
  support::CsvReader table(file, {.header = support::CsvHeader::kRequired});
  if (table.columns().empty()) {
    table.refuse("the trace has no ticks", kRemedy);
  }
  for (const char* name : kRequired) {
    if (!table.find_column(name)) {
      table.refuse(fmt::format("the header has no column {}", name), kRemedy);
    }
  }
  std::vector<std::pair<std::size_t, Member>> members;
  for (Member& member : all_members()) {
    if (const auto column = table.find_column(member.column)) {
      members.emplace_back(*column, std::move(member));
    }
  }
  const auto state = table.find_column("state");
  const bool has_tip = table.find_column("tip_x_m").has_value();
  const bool has_parts = table.find_column("motor_force_x_N").has_value();
  std::vector<Sample> samples;
  while (table.next_row()) {
    Sample sample = blank_sample(has_parts);
    for (const auto& [column, member] : members) {
      const double value = table.number(column);
      if (!is_float(value)) {
        table.refuse(member.column + " is not a float32 number", kRemedy);
      }
      member.set(sample, value);
    }
    sample.status.state = state ? state_of(table.cells()[*state]) : core::State::kBoot;
    if (!has_tip) {
      use_probe_as_tip(sample);
    }
    if (!samples.empty() && !(sample.t_s > samples.back().t_s)) {
      table.refuse("t_s does not increase", kRemedy);
    }
    samples.push_back(sample);
    if (samples.size() > kMaxTicks) {
      table.refuse(fmt::format("more than {} ticks", kMaxTicks), kShorter);
    }
  }
  if (samples.empty()) {
    table.refuse("the trace has no ticks", kRemedy);
  }
  return samples;
}

/// Sets one member of every sample.
void set_all(const telemetry::NpzReader& archive, const Member& member,
             std::vector<Sample>& samples) {
  const std::vector<double> values = archive.values(member.column);
  if (values.size() != samples.size()) {
    archive.refuse(member.column,
                   fmt::format("{} values instead of {}", values.size(), samples.size()));
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!is_float(values[i])) {
      archive.refuse(member.column, fmt::format("row {} is not a finite float32 number", i));
    }
    member.set(samples[i], values[i]);
  }
}

/// The member of the column `state`, whose values are indices of words.
Member state_member(const telemetry::NpzReader& archive) {
  std::vector<core::State> states;
  for (const std::string& word : archive.words("state")) {
    states.push_back(state_of(word));
  }
  return {"state", [states](Sample& sample, double value) {
            const std::uint32_t index = index_of(value, 0);
            sample.status.state = index < states.size() ? states[index] : core::State::kBoot;
          }};
}

std::vector<Sample> read_archive(const std::filesystem::path& file) {
  const telemetry::NpzReader archive(file, kMaxTicks);
  const std::size_t rows = archive.values("t_s").size();
  if (rows == 0) {
    archive.refuse("t_s", "the recording has no ticks", kRemedy);
  }
  std::vector<Sample> samples(rows, blank_sample(archive.has("motor_force_x_N")));
  std::vector<Member> members = all_members();
  if (archive.has("state")) {
    members.push_back(state_member(archive));
  }
  for (const Member& member : members) {
    const bool is_required =
        std::find(std::begin(kRequired), std::end(kRequired), member.column) != std::end(kRequired);
    if (is_required || archive.has(member.column)) {
      set_all(archive, member, samples);
    }
  }
  const bool has_tip = archive.has("tip_x_m");
  for (std::size_t i = 0; i < rows; ++i) {
    if (!has_tip) {
      use_probe_as_tip(samples[i]);
    }
    if (i > 0 && !(samples[i].t_s > samples[i - 1].t_s)) {
      archive.refuse("t_s", fmt::format("row {} is not later than the preceding one", i), kRemedy);
    }
  }
  return samples;
}

}  // namespace

std::vector<Sample> read_trace(const std::filesystem::path& file) {
  return file.extension() == ".npz" ? read_archive(file) : read_csv(file);
}

}  // namespace tactree::viewer
