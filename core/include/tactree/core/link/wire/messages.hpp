#pragma once
// Messages of the wire protocol: kinds, status codes and the payload of each message, with the same
// layout in memory as on the wire (little-endian, no padding). docs/PROTOCOL.md specifies their
// use; scripts/generate writes its tables from this header.
//
// A request has a kind of 0x01 .. 0x3F. Its reply has the same kind with kReplyBit, the request's
// sequence number and a WireStatus; the payload is empty unless the status is kOk, except for
// WriteModelReply and FinishModelReply. An unsolicited message of the board has a kind of 0x40 ..
// 0x7F.
//
// Interrupt safety: plain data and pure functions.

#include <cstdint>

#include "tactree/core/link/wire/frame.hpp"

namespace tactree::core::wire {

inline constexpr std::uint8_t kProtocolMajor = 1;
inline constexpr std::uint8_t kProtocolMinor = 2;
inline constexpr std::uint8_t kReplyBit = 0x80;

enum class MessageKind : std::uint8_t {
  kIdentify = 0x01,        ///< name, version and serial number; needs no session
  kOpen = 0x02,            ///< begins a session, ends the one before
  kClose = 0x03,           ///< ends the session, and stops
  kHeartbeat = 0x04,       ///< the only message that keeps a required link alive
  kCapabilities = 0x05,    ///< features and limits of the board; since 1.1 also without session
  kState = 0x06,           ///< state and faults
  kControl = 0x07,         ///< arm, stop ...; stop needs no session
  kSetLimits = 0x08,       ///< limits of the force
  kSetMaterial = 0x09,     ///< stiffness, damping and friction of a contact
  kMoveBody = 0x0A,        ///< pose and velocity
  kAddForce = 0x0B,        ///< a force of the application, added to the contact force
  kSubscribe = 0x0C,       ///< telemetry: fields and decimation
  kSetTexture = 0x0D,      ///< bumps of the surface; since 1.2
  kListModels = 0x10,      ///< slots of the model store
  kBeginModel = 0x11,      ///< erases the slot that is not in use
  kWriteModel = 0x12,      ///< a piece of the model
  kFinishModel = 0x13,     ///< validates the written model
  kActivateModel = 0x14,   ///< selects the model of a slot
  kRollBackModel = 0x15,   ///< returns to the previous model
  kEraseModel = 0x16,      ///< erases the slot that is not in use
  kReadTrace = 0x20,       ///< records of the flight recorder
  kReadFault = 0x21,       ///< conditions when the first fault was latched
  kReadStart = 0x22,       ///< result of the start; needs no session
  kGetParameter = 0x28,    ///< device calibration: value, range, name
  kSetParameter = 0x29,    ///< changes a parameter until the next reset
  kSaveParameters = 0x2A,  ///< stores all parameters
  kTelemetry = 0x40,       ///< unsolicited
};

enum class WireStatus : std::uint8_t {
  kOk = 0,
  kUnknownKind = 1,     ///< this board does not know the message
  kBadLength = 2,       ///< the payload is shorter than the message
  kBadVersion = 3,      ///< another major version of the protocol
  kNoSession = 4,       ///< open a session first; or it has ended
  kBadValue = 5,        ///< a field is not finite, out of range, or refers to nothing
  kBusy = 6,            ///< armed or active: stop first
  kNotNow = 7,          ///< the state does not allow it
  kUnstable = 8,        ///< stiffer than device, hand and rate allow
  kBadToken = 9,        ///< confirm: not the token of the reply to arm
  kUnsupported = 10,    ///< this board has no such part
  kNoTransfer = 11,     ///< begin a transfer first; or it was aborted
  kOutOfOrder = 12,     ///< the piece does not follow the one before it
  kTooLarge = 13,       ///< the slot is smaller
  kWrongBoard = 14,     ///< the model was made for another board
  kOldCounter = 15,     ///< the model is older than one used before: see anti-rollback
  kBadChecksum = 16,    ///< the stored bytes do not match the announced checksum
  kBadModel = 17,       ///< open_blob() or the controller refuses the model
  kBadSignature = 18,   ///< not signed by the key that the board trusts
  kInterrupted = 19,    ///< the transfer sent fewer bytes than announced
  kOtherWriter = 20,    ///< another session writes a model
  kNoModel = 21,        ///< the slot holds no usable model
  kInUse = 22,          ///< the slot holds the model in use
  kStorageFailed = 23,  ///< the flash reported an error
  kQueueFull = 24,      ///< too many pending requests: wait for replies
  kNotHomed = 25,       ///< arm: home the device first; since 1.1, before: kNotNow
  kWatchOnly = 26,      ///< this board is operated by its button; since 1.1, before: kUnsupported
};
inline constexpr std::uint32_t kWireStatuses = 27;

/// Text for people, static storage: "the board does not know this message", ...
[[nodiscard]] const char* describe(WireStatus status);

// --- Session ---------------------------------------------------------------------------------

struct IdentifyReply {
  std::uint8_t version_major = kProtocolMajor;
  std::uint8_t version_minor = kProtocolMinor;
  std::uint16_t max_payload_bytes = kMaxPayload;
  char board[24] = {};           ///< its name, zero-terminated
  char firmware[24] = {};        ///< version, zero-terminated
  std::uint32_t serial[3] = {};  ///< unique number; zeros: none
};

struct OpenRequest {
  std::uint8_t version_major = kProtocolMajor;
  std::uint8_t version_minor = kProtocolMinor;
  /// 0: not monitored; 5 .. 100 ms: without a heartbeat the force ends within this time.
  std::uint16_t link_timeout_ms = 0;
  std::uint32_t nonce = 0;  ///< returned in the reply, to identify it
};

struct OpenReply {
  std::uint8_t version_major = kProtocolMajor;
  std::uint8_t version_minor = kProtocolMinor;  ///< the smaller one of both sides
  std::uint16_t session = 0;                    ///< for the header of all later requests
  std::uint32_t nonce = 0;
  std::uint32_t board_time_us = 0;
};

/// Proves that the host has recently received from the board. Otherwise a queue of old heartbeats
/// would keep a dead link alive.
struct HeartbeatRequest {
  std::uint32_t board_time_us = 0;  ///< the newest time received from the board
};

struct HeartbeatReply {
  std::uint32_t board_time_us = 0;
  std::uint32_t age_us = 0;  ///< age of the request's board_time_us on arrival
};

// --- Capabilities, state, control ------------------------------------------------------------

struct CapabilitiesReply {
  float rate_hz = 0.0F;
  float force_max_N = 0.0F;          ///< present setting
  float force_limit_N = 0.0F;        ///< largest value for kSetLimits
  float slew_N_s = 0.0F;             ///< present setting
  float slew_limit_N_s = 0.0F;       ///< largest value for kSetLimits
  float host_force_max_N = 0.0F;     ///< longest vector for kAddForce
  float stiffness_N_m = 0.0F;        ///< present setting
  float stiffness_limit_N_m = 0.0F;  ///< with a light hand
  std::uint32_t bodies_max = 0;
  std::uint32_t bodies = 0;           ///< present bodies: bit n is body n
  std::uint32_t slots = 0;            ///< model slots; 0: the model is part of the image
  std::uint32_t slot_bytes = 0;       ///< largest size of a model
  std::uint32_t flags = 0;            ///< BoardFlag
  std::uint32_t trace_ticks = 0;      ///< capacity of the flight recorder
  std::uint32_t parameters = 0;       ///< number of them
  std::uint32_t cycles_per_tick = 0;  ///< core clock cycles per period; 0: unknown
};

enum class BoardFlag : std::uint32_t {
  kSignatureRequired = 1U << 0,  ///< a model must be signed
  kDeadManRequired = 1U << 1,    ///< a dead-man control confirms; else the message confirm
  kLinkRequired = 1U << 2,       ///< this session ends with its link
  kHomed = 1U << 3,
  kWorkReduced = 1U << 4,  ///< Controller::work_is_reduced()
  /// Operated by its panel alone: an application may watch and stop; since 1.1.
  kWatchOnly = 1U << 5,
  /// With kWatchOnly: the port of a server that shares the board; since 1.1.
  kShared = 1U << 6,
};

[[nodiscard]] constexpr bool has_flag(const CapabilitiesReply& board, BoardFlag flag) {
  return (board.flags & static_cast<std::uint32_t>(flag)) != 0U;
}

struct StateReply {
  std::uint32_t tick = 0;
  std::uint8_t state = 0;          ///< State
  std::uint8_t configuration = 0;  ///< ConfigurationStatus of the start
  std::uint8_t blob = 0;           ///< BlobStatus of the start
  std::uint8_t model = 0;          ///< ModelStatus of the start
  std::uint32_t faults = 0;        ///< FaultMask
  std::uint32_t limits = 0;        ///< LimitMask
  std::uint32_t overruns = 0;
  std::uint32_t board_time_us = 0;
  float probe_m[3] = {};
  float force_N[3] = {};
};

enum class ControlCode : std::uint8_t {
  kArm = 1,      ///< idle to armed; the reply has a token
  kConfirm = 2,  ///< armed to active, with that token; refused on boards with a dead-man control
  kStop = 3,     ///< allowed at any time, from any session, with any sequence number
  kClearFault = 4,
  kHome = 5,  ///< the device is in its home pose
};

struct ControlRequest {
  std::uint8_t code = 0;  ///< ControlCode
  std::uint8_t reserved[3] = {};
  std::uint32_t token = 0;  ///< kConfirm: from the reply to kArm; else 0
};

struct ControlReply {
  std::uint8_t state = 0;  ///< State after the tick that executed the request
  std::uint8_t reserved[3] = {};
  std::uint32_t faults = 0;
  std::uint32_t token = 0;  ///< after kArm; else 0
};

// --- Limits and contact ----------------------------------------------------------------------

struct SetLimitsRequest {
  float force_max_N = 0.0F;  ///< 0.01 .. force_limit_N
  float slew_N_s = 0.0F;     ///< up to slew_limit_N_s
  float ramp_s = 0.0F;       ///< 2 ticks .. 10 s
};

struct SetMaterialRequest {
  float stiffness_N_m = 0.0F;
  float damping_Ns_m = 0.0F;
  float static_friction = 0.0F;
  float dynamic_friction = 0.0F;
  std::uint32_t use_materials = 1;  ///< 1: use the model's materials, if any
};

struct SetTextureRequest {
  float height_m = 0.0F;      ///< 0 .. 0.01, at most half of the wavelength; 0: smooth
  float wavelength_m = 0.0F;  ///< 1e-4 .. 1
};

struct MoveBodyRequest {
  std::uint32_t body = 0;
  std::uint32_t enabled = 1;
  float rotation_wxyz[4] = {1.0F, 0.0F, 0.0F, 0.0F};
  float translation_m[3] = {};
  float linear_m_s[3] = {};
  float angular_rad_s[3] = {};
};

struct AddForceRequest {
  float force_N[3] = {};          ///< device frame; scaled down if longer than the limit
  std::uint32_t duration_ms = 0;  ///< 1 .. 100; then the force ends unless renewed
};

// --- Telemetry -------------------------------------------------------------------------------

/// Fields of a telemetry message. The subscribed ones follow TelemetryHeader in this order.
enum class TelemetryField : std::uint32_t {
  kState = 1U << 0,      ///< u32 State, u32 faults, u32 limits
  kProbe = 1U << 1,      ///< f32[3] m
  kVelocity = 1U << 2,   ///< f32[3] m/s
  kForce = 1U << 3,      ///< f32[3] N, applied
  kProxy = 1U << 4,      ///< f32[3] m
  kNormal = 1U << 5,     ///< f32[3]
  kContact = 1U << 6,    ///< f32 penetration m, u32 body, f32 share of the force displayed
  kWanted = 1U << 7,     ///< f32[3] N, before the gate
  kTiming = 1U << 8,     ///< u32 overruns, f32 share of the period used by the last tick
  kReactions = 1U << 9,  ///< twice: u32 body, f32[3] force N, f32[3] torque Nm
  /// f32[3] N each, at the probe: gravity compensation, added force, all motors; since 1.1
  kParts = 1U << 10,
};
inline constexpr std::uint32_t kTelemetryFields = 11;

/// The fields that exist in version 1.`minor` of the protocol.
[[nodiscard]] constexpr std::uint32_t telemetry_fields_of(std::uint8_t minor) {
  const std::uint32_t all = (1U << kTelemetryFields) - 1U;
  return minor == 0U ? all & ~static_cast<std::uint32_t>(TelemetryField::kParts) : all;
}

/// Bytes of each field, in the order above.
inline constexpr std::uint32_t kTelemetryFieldBytes[kTelemetryFields] = {12, 12, 12, 12, 12, 12,
                                                                         12, 12, 8,  56, 36};

struct SubscribeRequest {
  std::uint32_t fields = 0;      ///< TelemetryField flags of the fields
  std::uint32_t decimation = 0;  ///< ticks per message; 0: no messages
};

struct TelemetryHeader {
  std::uint32_t tick = 0;
  std::uint32_t board_time_us = 0;
  std::uint32_t fields = 0;   ///< TelemetryField flags of the fields
  std::uint32_t dropped = 0;  ///< messages dropped since the subscription
};

// --- Model store -----------------------------------------------------------------------------

enum class SlotState : std::uint8_t {
  kEmpty = 0,
  kPartial = 1,  ///< a transfer was begun and not finished
  kReady = 2,    ///< checked, not in use
  kActive = 3,   ///< in use, or will be after the next start
  kDamaged = 4,  ///< the contents have changed since validation
};

struct ModelSlot {
  std::uint8_t state = 0;  ///< SlotState
  std::uint8_t blob = 0;   ///< BlobStatus
  std::uint8_t flags = 0;  ///< bit 0: signed
  std::uint8_t reserved = 0;
  std::uint32_t bytes = 0;
  std::uint32_t checksum = 0;  ///< CRC-32 of all bytes
  std::uint32_t counter = 0;   ///< anti-rollback
  std::uint32_t points = 0;
};

struct ListModelsReply {
  std::uint32_t counter_min = 0;  ///< a signed model with a smaller counter is refused
  std::uint32_t slots = 0;
  ModelSlot slot[2]{};
};

/// A signature covers this manifest followed by the bytes of the model.
struct ModelManifest {
  char purpose[16] = {'t', 'a', 'c', 't', 'r', 'e', 'e', '-', 'm', 'o', 'd', 'e', 'l', '-', '1', 0};
  char board[24] = {};        ///< board that may use the model, zero-terminated; empty: any
  std::uint32_t counter = 0;  ///< anti-rollback: not smaller than that of any model used before
  std::uint32_t bytes = 0;
};

struct BeginModelRequest {
  char board[24] = {};         ///< as in ModelManifest
  std::uint32_t counter = 0;   ///< as in ModelManifest
  std::uint32_t bytes = 0;     ///< size of the model
  std::uint32_t checksum = 0;  ///< CRC-32 of all bytes
};

struct BeginModelReply {
  std::uint32_t slot = 0;
};

/// Followed by 1 .. kMaxPiece bytes, a multiple of 32 but for the last piece.
struct WriteModelRequest {
  std::uint32_t offset = 0;
};
inline constexpr std::uint32_t kMaxPiece = 256;

/// Also sent with kOutOfOrder; the transfer continues at next_offset.
struct WriteModelReply {
  std::uint32_t next_offset = 0;
};

struct FinishModelRequest {
  std::uint32_t is_signed = 0;
  std::uint8_t signature[64] = {};  ///< Ed25519, of ModelManifest and model
};

/// Of kFinishModel, also with kBadModel.
struct FinishModelReply {
  std::uint32_t slot = 0;
  std::uint8_t blob = 0;   ///< BlobStatus
  std::uint8_t model = 0;  ///< ModelStatus
  std::uint8_t reserved[2] = {};
};

/// Of kActivateModel and kEraseModel.
struct SlotRequest {
  std::uint32_t slot = 0;
};

// --- Trace, parameters -----------------------------------------------------------------------

struct ReadTraceRequest {
  std::uint32_t age = 0;    ///< age of the first record; 0: the newest
  std::uint32_t count = 0;  ///< 1 .. kMaxTraceRecords, towards older records
};

/// Followed by `count` records of 18 bytes (FlightRecord).
struct ReadTraceReply {
  std::uint32_t last_tick = 0;  ///< of the newest record
  std::uint32_t total = 0;      ///< records available
  std::uint32_t age = 0;
  std::uint32_t count = 0;  ///< may be less than requested
};
inline constexpr std::uint32_t kMaxTraceRecords = 13;

struct ReadFaultReply {
  std::uint32_t faults = 0;  ///< 0: no fault
  std::uint32_t tick = 0;
  float probe_m[3] = {};
  float proxy_m[3] = {};
  float velocity_m_s[3] = {};
  float force_N[3] = {};
};

/// Parts of a board that failed to start. Any failure disables the force.
enum class StartPart : std::uint32_t {
  kEncoders = 1U << 0,
  kMotors = 1U << 1,
  kEnableLine = 1U << 2,
  kSafetyInputs = 1U << 3,
  kWatchdog = 1U << 4,          ///< or its timeout was not restored after an erase of the flash
  kReceiver = 1U << 5,          ///< receiver of the link: bytes at full speed are lost
  kUsb = 1U << 6,               ///< USB controller
  kCrystal = 1U << 8,           ///< no oscillation: the core is slow
  kCrystalFrequency = 1U << 9,  ///< another crystal than the board's
  kWaitStates = 1U << 10,       ///< wait states of the flash
  kPll = 1U << 11,              ///< does not lock
  kClockSwitch = 1U << 12,      ///< the core stays on its internal oscillator
};

/// The first four fields state why there is no model; 0: no error.
struct ReadStartReply {
  std::uint8_t configuration = 0;  ///< ConfigurationStatus
  std::uint8_t blob = 0;           ///< BlobStatus
  std::uint8_t model = 0;          ///< ModelStatus
  std::uint8_t image = 0;          ///< 1: checksum of the program is wrong; 2: RAM self-test failed
  std::uint32_t missing = 0;       ///< StartPart flags of the parts that failed
  std::uint32_t by_watchdog = 0;   ///< 1: the watchdog caused the last reset
  std::uint32_t fault_cause = 0;   ///< cause of the last crash; 0: none; see CapturedFault
  std::uint32_t fault_status = 0;  ///< Arm: CFSR; RISC-V: mstatus
  std::uint32_t fault_address = 0;         ///< Arm: BFAR or MMFAR; RISC-V: mtval
  std::uint32_t fault_pc = 0;              ///< the failed instruction, or one shortly after it
  std::uint32_t fault_lr = 0;              ///< return address
  std::uint32_t fault_sp = 0;              ///< stack pointer
  std::uint32_t fault_registers[13] = {};  ///< Arm: r0-r12; RISC-V: a0-a7, t0-t4
};

struct GetParameterRequest {
  std::uint32_t number = 0;  ///< 0 .. CapabilitiesReply::parameters - 1
};

struct ParameterReply {
  std::uint32_t number = 0;
  float value = 0.0F;
  float min = 0.0F;
  float max = 0.0F;
  char name[40] = {};  ///< zero-terminated
};

struct SetParameterRequest {
  std::uint32_t number = 0;
  float value = 0.0F;
};

static_assert(sizeof(IdentifyReply) == 64 && sizeof(OpenRequest) == 8 && sizeof(OpenReply) == 12);
static_assert(sizeof(HeartbeatRequest) == 4 && sizeof(HeartbeatReply) == 8);
static_assert(sizeof(CapabilitiesReply) == 64 && sizeof(StateReply) == 48);
static_assert(sizeof(ControlRequest) == 8 && sizeof(ControlReply) == 12);
static_assert(sizeof(SetLimitsRequest) == 12 && sizeof(SetMaterialRequest) == 20);
static_assert(sizeof(SetTextureRequest) == 8);
static_assert(sizeof(MoveBodyRequest) == 60 && sizeof(AddForceRequest) == 16);
static_assert(sizeof(SubscribeRequest) == 8 && sizeof(TelemetryHeader) == 16);
static_assert(sizeof(ModelSlot) == 20 && sizeof(ListModelsReply) == 48);
static_assert(sizeof(ModelManifest) == 48 && sizeof(BeginModelRequest) == 36);
static_assert(sizeof(BeginModelReply) == 4 && sizeof(WriteModelRequest) == 4);
static_assert(sizeof(WriteModelReply) == 4 && sizeof(FinishModelRequest) == 68);
static_assert(sizeof(FinishModelReply) == 8 && sizeof(SlotRequest) == 4);
static_assert(sizeof(ReadTraceRequest) == 8 && sizeof(ReadTraceReply) == 16);
static_assert(sizeof(ReadStartReply) == 88);
static_assert(sizeof(ReadFaultReply) == 56 && sizeof(GetParameterRequest) == 4);
static_assert(sizeof(ParameterReply) == 56 && sizeof(SetParameterRequest) == 8);
static_assert(sizeof(WriteModelRequest) + kMaxPiece <= kMaxPayload);
static_assert(sizeof(ReadTraceReply) + 18U * kMaxTraceRecords <= kMaxPayload);

}  // namespace tactree::core::wire
