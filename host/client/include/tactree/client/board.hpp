#pragma once
// A board with a haptic device, for an application:
//
//   tactree::client::Board board("/dev/ttyACM0");
//   board.subscribe({.every_ticks = 10});
//   board.arm();                                     // waits for the dead-man control
//   while (running) {
//     board.move_body(0, pose_of_my_object());       // none of these wait
//     draw(board.latest());
//   }
//   board.stop();
//
// A function marked "waits" waits for the board's answer, at most a second unless stated otherwise,
// and throws LinkError where the board refuses, is silent or gone. The rest returns at once.

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tactree/client/connection.hpp"
#include "tactree/client/serial_port.hpp"
#include "tactree/client/start_report.hpp"
#include "tactree/core/control/flight_recorder.hpp"
#include "tactree/core/math/pose.hpp"

namespace tactree::client {

struct BoardOptions {
  unsigned baud = kUsualBaud;  ///< of a serial port
  /// 5 .. 100: force ends when this program does not run for that long. 0: force goes on without
  /// it.
  std::uint16_t link_timeout_ms = 0;
};

struct Subscription {
  std::uint32_t fields = 0x1FF;    ///< TelemetryField, or of them
  std::uint32_t every_ticks = 10;  ///< 0: end it
};

/// A model to be written to a board.
struct ModelFile {
  std::span<const std::byte> bytes;
  std::string board;          ///< only for the board of this name; empty: for any
  std::uint32_t counter = 0;  ///< anti-rollback
  bool is_signed = false;
  std::array<std::uint8_t, 64> signature{};
};

struct TracedTick {
  std::uint32_t tick = 0;
  core::FlightRecord record{};
};

/// "motor-fault, link-lost"; empty: there is none.
[[nodiscard]] std::string names_of(core::FaultMask faults);

/// The identity of a board and its start: see complaints() of start_report.hpp.
struct Introduction {
  core::wire::IdentifyReply board{};
  core::wire::ReadStartReply start{};  ///< no complaints, for a board without this message
};

class Board {
 public:
  /// A port by its path. Opens a session; waits.
  explicit Board(const std::string& port, const BoardOptions& options = {});
  Board(std::unique_ptr<Transport> transport, const BoardOptions& options);
  /// Closes the session: the board stops.
  ~Board();
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  /// After the connection was lost: opens the port and a new session, and renews the subscription.
  /// Nothing is armed. Throws while the board is not there; then try again.
  /// For boards opened by their port's name; not while another thread uses this one. Waits.
  void reconnect();
  /// False after the cable was pulled, or the board was reset.
  [[nodiscard]] bool connected() const { return connection_ && connection_->connected(); }

  /// Identity and start of the board, without a session: does not disturb another client. Waits.
  [[nodiscard]] static Introduction introduce(std::unique_ptr<Transport> transport);

  // ---- these wait
  [[nodiscard]] core::wire::IdentifyReply identify();
  [[nodiscard]] core::wire::CapabilitiesReply capabilities();
  [[nodiscard]] core::wire::StateReply state();
  /// Until there may be force. Where the board has a dead-man control, until it is held, at most
  /// `patience`. Throws, and stops, where it takes longer.
  void arm(std::chrono::milliseconds patience = std::chrono::seconds(30));
  /// Arms and does not wait for the hand: go_on_arming() does the rest. Throws where the state does
  /// not allow it.
  void begin_arming();
  /// Again and again after begin_arming(): true once there may be force. Confirms where the board
  /// has no dead-man control. Throws where the board is not armed any more.
  [[nodiscard]] bool go_on_arming();
  /// The action expected from the person at the device before there is force, as text.
  [[nodiscard]] const char* who_confirms() const;
  void stop();
  void clear_faults();  ///< and stops, so that the board is ready again
  void home();          ///< the device is in its home pose
  void set_limits(float force_max_N, float slew_N_s, float ramp_s);
  void set_material(const core::wire::SetMaterialRequest& material);
  void subscribe(const Subscription& subscription);
  [[nodiscard]] std::vector<TracedTick> trace();  ///< oldest first
  [[nodiscard]] core::wire::ReadFaultReply first_fault();
  [[nodiscard]] std::vector<core::wire::ParameterReply> parameters();
  void set_parameter(const std::string& name, float value);
  void save_parameters();

  // ---- models; these wait, for as long as the flash takes
  using Progress = std::function<void(std::size_t done, std::size_t all)>;
  [[nodiscard]] core::wire::ListModelsReply models();
  /// Writes a model, has it checked and used from now on. The one before stays in the other slot.
  void flash(const ModelFile& model, const Progress& progress = {});
  void roll_back();
  void erase_model(std::uint32_t slot);

  // ---- these do not
  /// Sent at once, and perhaps lost: stop() makes sure. Also while another thread uses the board,
  /// but for reconnect().
  void post_stop();
  void move_body(std::uint32_t body, const core::Pose& pose, const core::Motion& motion = {},
                 bool enabled = true);
  void add_force(const std::array<float, 3>& force_N, std::uint32_t duration_ms);
  /// All zero before the first.
  [[nodiscard]] Telemetry latest() const {
    return connection_ ? connection_->latest().value_or(Telemetry{}) : Telemetry{};
  }
  [[nodiscard]] std::vector<Telemetry> take_stream() {
    return connection_ ? connection_->take_stream() : std::vector<Telemetry>{};
  }
  [[nodiscard]] std::uint64_t dropped() const { return connection_ ? connection_->dropped() : 0U; }
  [[nodiscard]] bool in_session() const { return connection_ && connection_->in_session(); }

  /// Throws after a reconnect() that failed.
  [[nodiscard]] Connection& connection() const;

 private:
  Response demand(core::wire::MessageKind kind, std::span<const std::byte> payload,
                  const char* what);
  template <core::wire::Message T>
  Response demand(core::wire::MessageKind kind, const T& message, const char* what) {
    return demand(kind, std::as_bytes(std::span(&message, 1)), what);
  }
  template <core::wire::Message Reply>
  [[nodiscard]] Reply fetch(core::wire::MessageKind kind, const char* what);
  Response control(core::wire::ControlCode code, std::uint32_t token, const char* what);
  void write_pieces(std::span<const std::byte> bytes, const Progress& progress);

  std::string port_;  // empty: opened by a transport
  BoardOptions options_;
  std::optional<Subscription> subscription_;
  bool hand_confirms_ = false;              // of the last arming
  std::uint32_t arm_token_ = 0;             // of the last arming
  std::unique_ptr<Connection> connection_;  // none after a reconnect() that failed
};

}  // namespace tactree::client
