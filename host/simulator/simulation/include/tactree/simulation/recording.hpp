#pragma once
// Recording of a session in a file: all inputs of a controller, and a checksum of each tick's
// outcome. replay.hpp replays it on another controller.
//
// Format, version 4. Little-endian, no padding; a float is its float32 bits.
//
//   header   char[8] "TACTRREC", u32 version, u64 size of the file
//   events   u8 kind, then
//     1 model          u64 size of the blob, u8[32] first half of its SHA-512; models are numbered
//                      from 0 in this order
//     2 configuration  the fields of core::Configuration in the order of their declaration; enums
//                      and bools u8
//     3 load model     u32 model
//     4 add body       u32 model, pose (f32[4] rotation w x y z, f32[3] translation)
//     5 adjustment     the fields of core::Adjustment in the order of their declaration
//     6 trace begins   no data; the trace checksum covers the ticks after it
//     8 remove body    u32 number of the body
//     9 unload model   no data
//     7 tick           u16 mask of the fields that follow. All other fields have the values of the
//                      previous tick; fields marked "once" apply to one tick only.
//       bit 0..2  i32 count of the encoder
//           3     u8 flags: emergency stop, dead man, enable, motors ok, link alive, valid 0..2
//           4     u16 link age      5  u32 overruns    6  f32 load    7  f32 supply
//           11    u8[3] index pulses, i32[3] counts at them
//           8     u8 command, once
//           9     u8 number of body updates, once; of each u32 body, u8 enabled, pose, f32[3]
//                 linear, f32[3] angular velocity
//           12    no data; the storage is busy, once
//           10    f32[3] added force, u32 ticks, once
//                      then u32 CRC-32 of the outcome: f32[3] efforts, f32[3] force, u32 faults,
//                      u32 limits, u8 state, u8 enable
//   end      u8 0, u64 ticks, u32 trace checksum, u32 CRC-32 of all bytes before this one
//
// Host only. Not thread safe.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "tactree/core/control/controller.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/hal/sim/session_recorder.hpp"

namespace tactree::simulation {

inline constexpr std::uint32_t kRecordingVersion = 4;

/// Identity of a blob: its size and the first half of its SHA-512.
struct ModelDigest {
  std::uint64_t bytes = 0;
  std::array<std::uint8_t, 32> hash{};
  bool operator==(const ModelDigest&) const = default;
};
[[nodiscard]] ModelDigest digest_of(std::span<const std::byte> blob);

/// CRC-32 of the outcome of a tick: kind 7 above.
[[nodiscard]] std::uint32_t checksum_of(const hal::sim::TickOutcome& outcome);

/// Writes a session to memory. Pass it as hal::sim::BoardParameters::recorder.
class SessionWriter final : public hal::sim::SessionRecorder {
 public:
  SessionWriter();

  void configured(const core::Configuration& configuration) override;
  void adjusted(const core::Adjustment& adjustment) override;
  void model_loaded(const core::BlobView& view) override;
  void body_added(const core::BlobView& view, const core::Pose& pose) override;
  void body_removed(std::uint32_t number) override;
  void model_unloaded() override;
  void ticked(const core::Input& input, const hal::sim::TickOutcome& outcome) override;
  /// Starts the trace checksum at the next tick.
  void begin_trace();

  /// Ends the recording and returns the bytes of the file. Call it once, last.
  [[nodiscard]] const std::vector<std::byte>& finish();

 private:
  [[nodiscard]] std::uint32_t number_of(const core::BlobView& view);

  std::vector<std::byte> bytes_;
  std::vector<ModelDigest> models_;
  core::Readings last_{};
  core::Crc32 trace_{};
  std::uint64_t ticks_ = 0;
};

// ---- reading

struct LoadModel {
  std::uint32_t model = 0;
};
struct AddBody {
  std::uint32_t model = 0;
  core::Pose pose{};
};
struct RemoveBody {
  std::uint32_t number = 0;
};
struct UnloadModel {};
struct BeginTrace {};
struct RecordedTick {
  core::Readings readings{};
  std::vector<core::BodyUpdate> bodies;
  core::AddedForce added_force{};
  std::uint32_t outcome = 0;  ///< checksum
};
using RecordedEvent = std::variant<core::Configuration, core::Adjustment, LoadModel, AddBody,
                                   RemoveBody, UnloadModel, BeginTrace, RecordedTick>;

/// A recording is incomplete or damaged. The message contains the byte offset, cause and hint,
/// but not the name of the file.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The first bytes of a recording.
inline constexpr char kRecordingMagic[8] = {'T', 'A', 'C', 'T', 'R', 'R', 'E', 'C'};
inline constexpr std::size_t kRecordingHeaderBytes = 8 + 4 + 8;

/// Checks the header: the first kRecordingHeaderBytes of a file, or all bytes of a shorter file.
/// Throws RecordingError.
void check_recording_header(std::span<const std::byte> header, std::uint64_t file_bytes);

/// A recording in memory. The constructor checks all of it.
class Recording {
 public:
  /// `bytes` must outlive the recording. Throws RecordingError.
  explicit Recording(std::span<const std::byte> bytes);

  [[nodiscard]] const std::vector<ModelDigest>& models() const { return models_; }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  [[nodiscard]] std::uint32_t trace_crc32() const { return trace_crc32_; }

  /// Reads the next event. Returns false at the end of the recording.
  [[nodiscard]] bool next(RecordedEvent& event);
  /// Restarts next() at the first event.
  void rewind();

 private:
  void check_whole();
  void check_events();
  void take_event(std::uint8_t kind, std::size_t place, RecordedEvent& event);
  [[nodiscard]] std::uint32_t take_model(std::size_t place);

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  core::Readings last_{};
  std::vector<ModelDigest> models_;
  std::size_t models_read_ = 0;
  std::uint64_t ticks_ = 0;
  std::uint32_t trace_crc32_ = 0;
};

}  // namespace tactree::simulation
