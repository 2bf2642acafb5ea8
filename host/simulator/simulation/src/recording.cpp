#include "tactree/simulation/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

#include "recording_fields.hpp"

namespace tactree::simulation {
namespace {

// End event: kind, ticks, trace checksum, checksum of the file.
constexpr std::size_t kEndBytes = 1 + 8 + 4 + 4;
constexpr std::size_t kChecksumBytes = 4;

[[noreturn]] void refuse(std::size_t place, const std::string& cause, const std::string& remedy) {
  throw RecordingError(fmt::format("byte {}: {} ({})", place, cause, remedy));
}

constexpr char kRecordAgain[] = "record the session again";

/// Reads values from the bytes. Throws RecordingError beyond their end.
class Taker {
 public:
  Taker(std::span<const std::byte> bytes, std::size_t& at) : bytes_(bytes), at_(at) {}

  template <class T>
  void operator()(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      value = take<std::uint8_t>() != 0U;
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(take<std::uint8_t>());
    } else if constexpr (std::is_same_v<T, float>) {
      value = std::bit_cast<float>(take<std::uint32_t>());
    } else {
      static_assert(std::is_integral_v<T>);
      value = static_cast<T>(take<std::make_unsigned_t<T>>());
    }
  }

  template <class T>
  [[nodiscard]] T take() {
    if (bytes_.size() - at_ < sizeof(T)) {
      refuse(at_, "an event goes beyond the end of the events", kRecordAgain);
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      value |= std::to_integer<std::uint64_t>(bytes_[at_ + i]) << (8U * i);
    }
    at_ += sizeof(T);
    return static_cast<T>(value);
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t& at_;
};

void take_flags(std::uint8_t bits, core::Readings& r) {
  bool* const flags[8] = {&r.emergency_stop,    &r.dead_man,         &r.enable_read_back,
                          &r.motors_ok,         &r.link_alive,       &r.encoders.valid[0],
                          &r.encoders.valid[1], &r.encoders.valid[2]};
  for (unsigned i = 0; i < 8U; ++i) {
    *flags[i] = (bits >> i & 1U) != 0U;
  }
}

void take_readings(Taker& take, unsigned mask, core::Readings& r) {
  for (unsigned i = 0; i < core::kAxes; ++i) {
    if ((mask & (kCount0 << i)) != 0U) {
      take(r.encoders.counts[i]);
    }
  }
  if ((mask & kFlags) != 0U) {
    take_flags(take.take<std::uint8_t>(), r);
  }
  if ((mask & kLinkAge) != 0U) {
    take(r.link_age_ticks);
  }
  if ((mask & kOverruns) != 0U) {
    take(r.overruns);
  }
  if ((mask & kLoad) != 0U) {
    take(r.load);
  }
  if ((mask & kSupply) != 0U) {
    take(r.supply_V);
  }
  if ((mask & kIndex) != 0U) {
    visit(take, r.encoders.index);
    visit(take, r.encoders.index_count);
  }
  r.storage_busy = (mask & kStorageBusy) != 0U;
  r.command = core::Command::kNone;
  if ((mask & kCommand) != 0U) {
    take(r.command);
  }
}

RecordedTick take_tick(Taker& take, std::size_t place, core::Readings& last) {
  const auto mask = take.take<std::uint16_t>();
  if ((mask & ~kAllTickFields) != 0U) {
    refuse(place, fmt::format("a tick has unknown fields ({:#06x})", mask), kRecordAgain);
  }
  RecordedTick tick;
  take_readings(take, mask, last);
  tick.readings = last;
  if ((mask & kBodies) != 0U) {
    tick.bodies.resize(take.take<std::uint8_t>());
    for (core::BodyUpdate& update : tick.bodies) {
      visit(take, update);
    }
  }
  if ((mask & kForce) != 0U) {
    visit(take, tick.added_force);
  }
  take(tick.outcome);
  return tick;
}

}  // namespace

Recording::Recording(std::span<const std::byte> bytes) : bytes_(bytes) {
  check_whole();
  check_events();
}

void check_recording_header(std::span<const std::byte> header, std::uint64_t file_bytes) {
  const bool named = header.size() >= sizeof kRecordingMagic &&
                     std::memcmp(header.data(), kRecordingMagic, sizeof kRecordingMagic) == 0;
  if (!named) {
    refuse(0, "not a recording of a session", "give a file that simulate --record wrote");
  }
  if (header.size() < kRecordingHeaderBytes || file_bytes < kRecordingHeaderBytes + kEndBytes) {
    refuse(file_bytes, "the file ends within its header: it is truncated", kRecordAgain);
  }
  std::size_t at = sizeof kRecordingMagic;
  Taker take(header, at);
  const auto version = take.take<std::uint32_t>();
  if (version != kRecordingVersion) {
    refuse(sizeof kRecordingMagic,
           fmt::format("version {} of the format; this program reads version {}", version,
                       kRecordingVersion),
           "replay it with the version of tactree that recorded it");
  }
  const auto size = take.take<std::uint64_t>();
  if (size != file_bytes) {
    refuse(
        std::min(size, file_bytes),
        fmt::format("the file has {} bytes instead of {}: it is truncated or bytes were appended",
                    file_bytes, size),
        "copy it again, or " + std::string(kRecordAgain));
  }
}

void Recording::check_whole() {
  check_recording_header(bytes_.first(std::min(bytes_.size(), kRecordingHeaderBytes)),
                         bytes_.size());
  const std::size_t end = bytes_.size() - kChecksumBytes;
  std::size_t place = end;
  if (Taker(bytes_, place).take<std::uint32_t>() != core::crc32(bytes_.first(end))) {
    refuse(end, "the checksum does not match: the file is damaged",
           "copy it again, or " + std::string(kRecordAgain));
  }
  place = bytes_.size() - kEndBytes;
  Taker last(bytes_, place);
  if (last.take<std::uint8_t>() != static_cast<std::uint8_t>(EventKind::kEnd)) {
    refuse(bytes_.size() - kEndBytes, "the end of the recording is missing", kRecordAgain);
  }
  last(ticks_);
  last(trace_crc32_);
  bytes_ = bytes_.first(bytes_.size() - kEndBytes);
}

void Recording::check_events() {
  rewind();
  std::uint64_t ticks = 0;
  RecordedEvent event;
  while (next(event)) {
    ticks += std::holds_alternative<RecordedTick>(event) ? 1U : 0U;
  }
  if (ticks != ticks_) {
    refuse(bytes_.size(), fmt::format("{} ticks instead of {}", ticks, ticks_), kRecordAgain);
  }
  rewind();
}

void Recording::rewind() {
  at_ = kRecordingHeaderBytes;
  last_ = {};
  models_read_ = 0;
}

bool Recording::next(RecordedEvent& event) {
  while (at_ < bytes_.size()) {
    const std::size_t place = at_;
    Taker take(bytes_, at_);
    const auto kind = take.take<std::uint8_t>();
    if (static_cast<EventKind>(kind) == EventKind::kModel) {
      ModelDigest digest;
      take(digest.bytes);
      for (std::uint8_t& byte : digest.hash) {
        take(byte);
      }
      if (models_read_ == models_.size()) {
        models_.push_back(digest);
      }
      ++models_read_;
      continue;
    }
    take_event(kind, place, event);
    return true;
  }
  return false;
}

void Recording::take_event(std::uint8_t kind, std::size_t place, RecordedEvent& event) {
  Taker take(bytes_, at_);
  switch (static_cast<EventKind>(kind)) {
    case EventKind::kConfiguration:
      visit(take, event.emplace<core::Configuration>());
      return;
    case EventKind::kAdjustment:
      visit(take, event.emplace<core::Adjustment>());
      return;
    case EventKind::kLoadModel:
      event = LoadModel{take_model(place)};
      return;
    case EventKind::kAddBody: {
      AddBody body{take_model(place), {}};
      visit(take, body.pose);
      event = body;
      return;
    }
    case EventKind::kRemoveBody:
      event = RemoveBody{take.take<std::uint32_t>()};
      return;
    case EventKind::kUnloadModel:
      event = UnloadModel{};
      return;
    case EventKind::kBeginTrace:
      event = BeginTrace{};
      return;
    case EventKind::kTick:
      event = take_tick(take, place, last_);
      return;
    default:
      refuse(place, fmt::format("unknown kind of event {}", unsigned{kind}), kRecordAgain);
  }
}

std::uint32_t Recording::take_model(std::size_t place) {
  const auto model = Taker(bytes_, at_).take<std::uint32_t>();
  if (model >= models_read_) {
    refuse(place, fmt::format("model {}: the recording has {} so far", model, models_read_),
           kRecordAgain);
  }
  return model;
}

}  // namespace tactree::simulation
