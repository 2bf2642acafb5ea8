#include <algorithm>
#include <bit>
#include <iterator>
#include <type_traits>

#include "recording_fields.hpp"
#include "tactree/core/crypto/sha512.hpp"
#include "tactree/simulation/recording.hpp"

namespace tactree::simulation {
namespace {

// Offset of the file size in the header.
constexpr std::size_t kSizeOffset = sizeof kRecordingMagic + sizeof kRecordingVersion;

/// Appends values, little-endian.
class Appender {
 public:
  explicit Appender(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  template <class T>
  void operator()(const T& value) {
    if constexpr (std::is_enum_v<T> || std::is_same_v<T, bool>) {
      append(static_cast<std::uint8_t>(value));
    } else if constexpr (std::is_same_v<T, float>) {
      append(std::bit_cast<std::uint32_t>(value));
    } else {
      static_assert(std::is_integral_v<T>);
      append(static_cast<std::make_unsigned_t<T>>(value));
    }
  }

 private:
  template <class T>
  void append(T value) {
    for (std::size_t i = 0; i < sizeof value; ++i) {
      bytes_.push_back(static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8U * i)));
    }
  }

  std::vector<std::byte>& bytes_;
};

std::span<const std::byte> bytes_of(const core::BlobView& view) {
  return {reinterpret_cast<const std::byte*>(&view.header()), view.header().total_bytes};
}

std::uint8_t flags_of(const core::Readings& r) {
  const bool flags[8] = {r.emergency_stop,    r.dead_man,         r.enable_read_back,
                         r.motors_ok,         r.link_alive,       r.encoders.valid[0],
                         r.encoders.valid[1], r.encoders.valid[2]};
  unsigned bits = 0;
  for (unsigned i = 0; i < 8U; ++i) {
    bits |= flags[i] ? 1U << i : 0U;
  }
  return static_cast<std::uint8_t>(bits);
}

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

bool same_index(const core::EncoderReading& a, const core::EncoderReading& b) {
  return std::equal(std::begin(a.index), std::end(a.index), b.index) &&
         std::equal(std::begin(a.index_count), std::end(a.index_count), b.index_count);
}

void append_index(Appender& append, const core::EncoderReading& reading) {
  for (const bool passed : reading.index) {
    append(passed);
  }
  for (const std::int32_t count : reading.index_count) {
    append(count);
  }
}

unsigned changed_fields(const core::Readings& now, const core::Readings& last) {
  unsigned mask = 0;
  for (unsigned i = 0; i < core::kAxes; ++i) {
    mask |= now.encoders.counts[i] != last.encoders.counts[i] ? kCount0 << i : 0U;
  }
  mask |= flags_of(now) != flags_of(last) ? kFlags : 0U;
  mask |= now.link_age_ticks != last.link_age_ticks ? kLinkAge : 0U;
  mask |= now.overruns != last.overruns ? kOverruns : 0U;
  mask |= !same_bits(now.load, last.load) ? kLoad : 0U;
  mask |= !same_bits(now.supply_V, last.supply_V) ? kSupply : 0U;
  mask |= !same_index(now.encoders, last.encoders) ? kIndex : 0U;
  mask |= now.storage_busy ? kStorageBusy : 0U;
  mask |= now.command != core::Command::kNone ? kCommand : 0U;
  return mask;
}

void append_readings(Appender& append, unsigned mask, const core::Readings& r) {
  for (unsigned i = 0; i < core::kAxes; ++i) {
    if ((mask & (kCount0 << i)) != 0U) {
      append(r.encoders.counts[i]);
    }
  }
  if ((mask & kFlags) != 0U) {
    append(flags_of(r));
  }
  if ((mask & kLinkAge) != 0U) {
    append(r.link_age_ticks);
  }
  if ((mask & kOverruns) != 0U) {
    append(r.overruns);
  }
  if ((mask & kLoad) != 0U) {
    append(r.load);
  }
  if ((mask & kSupply) != 0U) {
    append(r.supply_V);
  }
  if ((mask & kIndex) != 0U) {
    append_index(append, r.encoders);
  }
  if ((mask & kCommand) != 0U) {
    append(r.command);
  }
}

}  // namespace

ModelDigest digest_of(std::span<const std::byte> blob) {
  std::uint8_t hash[core::Sha512::kBytes];
  core::Sha512 sha;
  sha.update(blob);
  sha.finish(hash);
  ModelDigest digest;
  digest.bytes = blob.size();
  std::copy_n(hash, digest.hash.size(), digest.hash.begin());
  return digest;
}

std::uint32_t checksum_of(const hal::sim::TickOutcome& outcome) {
  std::vector<std::byte> bytes;
  Appender append(bytes);
  for (const float effort : outcome.effort) {
    append(effort);
  }
  append(outcome.status.force.x);
  append(outcome.status.force.y);
  append(outcome.status.force.z);
  append(outcome.status.faults);
  append(outcome.status.limits);
  append(outcome.status.state);
  append(outcome.enable);
  return core::crc32(bytes);
}

SessionWriter::SessionWriter() {
  Appender append(bytes_);
  for (const char c : kRecordingMagic) {
    append(c);
  }
  append(kRecordingVersion);
  append(std::uint64_t{0});  // set by finish()
}

void SessionWriter::configured(const core::Configuration& configuration) {
  Appender append(bytes_);
  append(EventKind::kConfiguration);
  core::Configuration copy = configuration;
  visit(append, copy);
}

void SessionWriter::adjusted(const core::Adjustment& adjustment) {
  Appender append(bytes_);
  append(EventKind::kAdjustment);
  core::Adjustment copy = adjustment;
  visit(append, copy);
}

void SessionWriter::model_loaded(const core::BlobView& view) {
  const std::uint32_t model = number_of(view);
  Appender append(bytes_);
  append(EventKind::kLoadModel);
  append(model);
}

void SessionWriter::body_added(const core::BlobView& view, const core::Pose& pose) {
  const std::uint32_t model = number_of(view);
  Appender append(bytes_);
  append(EventKind::kAddBody);
  append(model);
  core::Pose copy = pose;
  visit(append, copy);
}

void SessionWriter::body_removed(std::uint32_t number) {
  Appender append(bytes_);
  append(EventKind::kRemoveBody);
  append(number);
}

void SessionWriter::model_unloaded() {
  Appender append(bytes_);
  append(EventKind::kUnloadModel);
}

void SessionWriter::ticked(const core::Input& input, const hal::sim::TickOutcome& outcome) {
  const core::Readings& readings = input;
  unsigned mask = changed_fields(readings, last_);
  mask |= input.bodies.empty() ? 0U : kBodies;
  mask |= input.added_force.ticks == 0U ? 0U : kForce;
  Appender append(bytes_);
  append(EventKind::kTick);
  append(static_cast<std::uint16_t>(mask));
  append_readings(append, mask, readings);
  if ((mask & kBodies) != 0U) {
    append(static_cast<std::uint8_t>(input.bodies.size()));
    for (core::BodyUpdate update : input.bodies) {
      visit(append, update);
    }
  }
  if ((mask & kForce) != 0U) {
    core::AddedForce force = input.added_force;
    visit(append, force);
  }
  append(checksum_of(outcome));
  const core::Vec3 force = outcome.status.force;
  const float components[3] = {force.x, force.y, force.z};
  trace_.update(std::as_bytes(std::span(components)));
  last_ = readings;
  ++ticks_;
}

void SessionWriter::begin_trace() {
  trace_ = {};
  Appender append(bytes_);
  append(EventKind::kBeginTrace);
}

const std::vector<std::byte>& SessionWriter::finish() {
  Appender append(bytes_);
  append(EventKind::kEnd);
  append(ticks_);
  append(trace_.value());
  std::vector<std::byte> size;
  Appender append_size(size);
  append_size(std::uint64_t{bytes_.size() + sizeof(std::uint32_t)});
  std::copy(size.begin(), size.end(), bytes_.begin() + kSizeOffset);
  append(core::crc32(bytes_));
  return bytes_;
}

std::uint32_t SessionWriter::number_of(const core::BlobView& view) {
  const ModelDigest digest = digest_of(bytes_of(view));
  const auto found = std::find(models_.begin(), models_.end(), digest);
  const auto number = static_cast<std::uint32_t>(found - models_.begin());
  if (found == models_.end()) {
    models_.push_back(digest);
    Appender append(bytes_);
    append(EventKind::kModel);
    append(digest.bytes);
    for (const std::uint8_t byte : digest.hash) {
      append(byte);
    }
  }
  return number;
}

}  // namespace tactree::simulation
