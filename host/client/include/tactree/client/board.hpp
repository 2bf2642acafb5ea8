#pragma once
// A board with a haptic device, for use by an application:
//
//   tactree::client::Board board("/dev/ttyACM0");
//   board.subscribe({.every_ticks = 10});
//   board.arm();                                     // waits for the dead-man control
//   while (running) {
//     board.move_body(0, pose_of_my_object());       // none of these block
//     draw(board.latest());
//   }
//   board.stop();
//
// A blocking function waits for the board's reply, at most one second unless stated otherwise, and
// throws LinkError if the board refuses, does not reply or is lost. All others return immediately.

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
  /// 5 .. 100: the force ends if this program does not run for that long. 0: the force continues.
  std::uint16_t link_timeout_ms = 0;
  /// Maximum number of telemetry messages that wait for take_stream(), see ConnectionOptions.
  std::size_t stream_capacity = ConnectionOptions{}.stream_capacity;
};

struct Subscription {
  std::uint32_t fields = 0x1FF;    ///< OR of TelemetryField bits; default: all but kReactions
  std::uint32_t every_ticks = 10;  ///< 0: end the subscription
};

/// A model to be written to a board.
struct ModelFile {
  std::span<const std::byte> bytes;
  std::string board;          ///< name of the only board that accepts it; empty: any board
  std::uint32_t counter = 0;  ///< anti-rollback counter
  bool is_signed = false;
  std::array<std::uint8_t, 64> signature{};
};

struct TracedTick {
  std::uint32_t tick = 0;
  core::FlightRecord record{};
};

/// Names of the faults, e.g. "motor-fault, link-lost"; empty if there are none.
[[nodiscard]] std::string names_of(core::FaultMask faults);

/// Identity of a board and the result of its start, see complaints() (start_report.hpp).
struct Introduction {
  core::wire::IdentifyReply board{};
  core::wire::ReadStartReply start{};   ///< without complaints if the board does not send it
  core::wire::CapabilitiesReply can{};  ///< zeros on older boards
};

class Board {
 public:
  /// Opens a port by its name (ports.hpp), and a session. Blocks.
  explicit Board(const std::string& port, const BoardOptions& options = {});
  Board(std::unique_ptr<Transport> transport, const BoardOptions& options);
  /// Closes the session: the board stops.
  ~Board();
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  /// Call after the connection was lost: opens the port and a new session, and renews the
  /// subscription. The board is not armed. Throws LinkError while the board is absent; try again
  /// then. Only for boards opened by port name, and not while another thread uses this object.
  /// Blocks.
  void reconnect();
  /// Returns false once the connection is lost, e.g. because the cable was unplugged.
  [[nodiscard]] bool connected() const { return connection_ && connection_->connected(); }

  /// Why there is no session, as text; empty while there is one.
  [[nodiscard]] std::string loss() const;

  /// Returns identity and start of a board without a session, so another client is not disturbed.
  /// Blocks.
  [[nodiscard]] static Introduction introduce(std::unique_ptr<Transport> transport);

  // ---- blocking functions
  [[nodiscard]] core::wire::IdentifyReply identify();
  [[nodiscard]] core::wire::CapabilitiesReply capabilities();
  [[nodiscard]] core::wire::StateReply state();
  /// Arms the board and waits until it is active. If the board has a dead-man control, the user
  /// must hold it. After `patience`, stops the board and throws LinkError.
  void arm(std::chrono::milliseconds patience = std::chrono::seconds(30));
  /// Arms the board and does not wait for the user: go_on_arming() completes it. Throws LinkError
  /// if the state does not allow it; the message names the faults.
  void begin_arming();
  /// Call repeatedly after begin_arming(): returns true once the board is active. Confirms if the
  /// board has no dead-man control. Throws LinkError if the board is no longer armed.
  [[nodiscard]] bool go_on_arming();
  /// The action required from the user before the board becomes active, as text.
  [[nodiscard]] const char* who_confirms() const;
  /// Names of the faults, and for link-lost what the user can do about this program's link.
  [[nodiscard]] std::string explain(core::FaultMask faults) const;
  /// Throws LinkError if the board is operated by its panel alone, or shared: one may then watch
  /// and stop (BoardFlag::kWatchOnly), and functions that change something throw. `what`: the
  /// intended command, for the message.
  void require_command(const char* what);
  void stop();
  void clear_faults();  ///< also stops the board, which makes it ready again
  void home();          ///< precondition: the device is in its home pose
  void set_limits(float force_max_N, float slew_N_s, float ramp_s);
  void set_material(const core::wire::SetMaterialRequest& material);
  void set_texture(const core::wire::SetTextureRequest& texture);
  void subscribe(const Subscription& subscription);
  /// Records of consecutive ticks, oldest first. The board records further ones meanwhile, so that
  /// a slow link reads fewer than the board has at first.
  [[nodiscard]] std::vector<TracedTick> trace();
  [[nodiscard]] core::wire::ReadFaultReply first_fault();
  [[nodiscard]] std::vector<core::wire::ParameterReply> parameters();
  void set_parameter(const std::string& name, float value);
  /// Origin of the model frame in the frame of the device, a parameter of the board.
  [[nodiscard]] core::Vec3 model_origin_m();
  /// Puts a body at rest at a pose of the model frame. As move_body(), but a board that refuses it
  /// is an error.
  void place_body(std::uint32_t body, const core::Pose& pose);
  void save_parameters();

  // ---- models: blocking functions, for as long as the flash is written
  using Progress = std::function<void(std::size_t done, std::size_t all)>;
  [[nodiscard]] core::wire::ListModelsReply models();
  /// Writes a model, has the board check it, and activates it. The preceding model stays in the
  /// other slot.
  void flash(const ModelFile& model, const Progress& progress = {});
  void roll_back();
  void erase_model(std::uint32_t slot);

  // ---- functions that do not block
  /// Sends a stop, which may be lost; stop() waits for the reply. May be called while another
  /// thread uses the board, except in reconnect().
  void post_stop();
  /// The body continues with `motion` until the next call, also after the end of the session.
  void move_body(std::uint32_t body, const core::Pose& pose, const core::Motion& motion = {},
                 bool enabled = true);
  void add_force(const std::array<float, 3>& force_N, std::uint32_t duration_ms);
  /// All zero before the first telemetry.
  [[nodiscard]] Telemetry latest() const {
    return connection_ ? connection_->latest().value_or(Telemetry{}) : Telemetry{};
  }
  [[nodiscard]] std::vector<Telemetry> take_stream() {
    return connection_ ? connection_->take_stream() : std::vector<Telemetry>{};
  }
  [[nodiscard]] std::uint64_t dropped() const { return connection_ ? connection_->dropped() : 0U; }
  [[nodiscard]] bool in_session() const { return connection_ && connection_->in_session(); }

  /// Throws LinkError after a reconnect() that failed.
  [[nodiscard]] Connection& connection() const;

 private:
  /// Says why the board refuses a value (WireStatus::kBadValue); "" if that is unknown.
  using Range = std::function<std::string()>;
  Response demand(core::wire::MessageKind kind, std::span<const std::byte> payload,
                  const char* what, const Range& range = {});
  template <core::wire::Message T>
  Response demand(core::wire::MessageKind kind, const T& message, const char* what,
                  const Range& range = {}) {
    return demand(kind, std::as_bytes(std::span(&message, 1)), what, range);
  }
  template <core::wire::Message Reply>
  [[nodiscard]] Reply fetch(core::wire::MessageKind kind, const char* what);
  [[nodiscard]] std::string stiffness_limit(const Response& refusal) const;
  void require_no_fault();
  void require_command(const core::wire::CapabilitiesReply& can, const char* what) const;
  Response control(core::wire::ControlCode code, std::uint32_t token, const char* what);
  void write_pieces(std::span<const std::byte> bytes, const Progress& progress);

  std::string port_;  // empty: constructed from a transport
  BoardOptions options_;
  std::optional<Subscription> subscription_;
  bool hand_confirms_ = false;              // of the last arming
  std::uint32_t arm_token_ = 0;             // of the last arming
  std::unique_ptr<Connection> connection_;  // nullptr after a reconnect() that failed
};

}  // namespace tactree::client
