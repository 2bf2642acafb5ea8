#pragma once
// What application and board tell each other: kinds, status codes and the payload of each message,
// laid out in memory as on the wire (little-endian, no padding). docs/PROTOCOL.md tells how they
// are used; scripts/check-protocol-doc compares the two.
//
// A request has a kind of 0x01 .. 0x3F; its reply has the same kind with kReplyBit, the request's
// sequence number and a WireStatus, and an empty payload where that is not kOk. What a board sends
// of its own accord has a kind of 0x40 .. 0x7F.

#include <cstddef>
#include <cstdint>

#include "tactree/core/wire/frame.hpp"

namespace tactree::core::wire {

inline constexpr std::uint8_t kProtocolMajor = 1;
inline constexpr std::uint8_t kProtocolMinor = 0;
inline constexpr std::uint8_t kReplyBit = 0x80;

enum class MessageKind : std::uint8_t {
  kIdentify = 0x01,        ///< who are you; needs no session
  kOpen = 0x02,            ///< begins a session, ends the one before
  kClose = 0x03,           ///< ends the session, and stops
  kHeartbeat = 0x04,       ///< the only message that keeps a required link alive
  kCapabilities = 0x05,    ///< what the board can do, and its limits
  kState = 0x06,           ///< state and faults
  kControl = 0x07,         ///< arm, stop ...; stop needs no session
  kSetLimits = 0x08,       ///< of the force
  kSetMaterial = 0x09,     ///< how a contact feels
  kMoveBody = 0x0A,        ///< pose and velocity
  kAddForce = 0x0B,        ///< a force of the application, on top of the contact's
  kSubscribe = 0x0C,       ///< telemetry: which fields, how often
  kListModels = 0x10,      ///< slots of the model store
  kBeginModel = 0x11,      ///< erases the slot that is not in use
  kWriteModel = 0x12,      ///< a piece of the model
  kFinishModel = 0x13,     ///< checks what was written
  kActivateModel = 0x14,   ///< uses it from now on
  kRollBackModel = 0x15,   ///< back to the model before
  kEraseModel = 0x16,      ///< of the slot that is not in use
  kReadTrace = 0x20,       ///< records of the flight recorder
  kReadFault = 0x21,       ///< what it was like when the first fault was latched
  kReadStart = 0x22,       ///< how the board started; needs no session
  kGetParameter = 0x28,    ///< device calibration: value, range, name
  kSetParameter = 0x29,    ///< changes it until the next reset
  kSaveParameters = 0x2A,  ///< keeps it
  kTelemetry = 0x40,       ///< of the board's own accord
};

enum class WireStatus : std::uint8_t {
  kOk = 0,
  kUnknownKind = 1,     ///< this board does not know the message
  kBadLength = 2,       ///< the payload is shorter than the message
  kBadVersion = 3,      ///< another major version of the protocol
  kNoSession = 4,       ///< open a session first; or it has ended
  kBadValue = 5,        ///< a field is not finite, out of its range, or names nothing
  kBusy = 6,            ///< armed or active: stop first
  kNotNow = 7,          ///< the state does not allow it
  kUnstable = 8,        ///< stiffer than device, hand and rate allow
  kBadToken = 9,        ///< confirm: not the token that arm gave
  kUnsupported = 10,    ///< this board has no such part
  kNoTransfer = 11,     ///< begin a transfer first; or it was broken off
  kOutOfOrder = 12,     ///< the piece does not follow the one before it
  kTooLarge = 13,       ///< the slot is smaller
  kWrongBoard = 14,     ///< the model was made for another board
  kOldCounter = 15,     ///< the model is older than one that was used: see anti-rollback
  kBadChecksum = 16,    ///< what was stored is not what was announced
  kBadModel = 17,       ///< open_blob() or the controller refuses it
  kBadSignature = 18,   ///< not signed by the key that the board trusts
  kInterrupted = 19,    ///< the transfer did not send all that was announced
  kOtherWriter = 20,    ///< another session writes
  kNoModel = 21,        ///< the slot holds no model that can be used
  kInUse = 22,          ///< the slot of the model that is in use
  kStorageFailed = 23,  ///< the flash did not take it
  kQueueFull = 24,      ///< too many requests at once: wait for replies
};
inline constexpr std::uint32_t kWireStatuses = 25;

/// The status as words for people: "another major version of the protocol", ...
[[nodiscard]] const char* describe(WireStatus status);

// --- Session ---------------------------------------------------------------------------------

struct IdentifyReply {
  std::uint8_t version_major = kProtocolMajor;
  std::uint8_t version_minor = kProtocolMinor;
  std::uint16_t max_payload_bytes = kMaxPayload;
  char board[24] = {};           ///< its name, zero-terminated
  char firmware[24] = {};        ///< version, zero-terminated
  std::uint32_t serial[3] = {};  ///< unique number; zeros: it has none
};

struct OpenRequest {
  std::uint8_t version_major = kProtocolMajor;
  std::uint8_t version_minor = kProtocolMinor;
  /// 0: the link may be lost; 5 .. 100 ms: then force ends at that time at the latest.
  std::uint16_t link_timeout_ms = 0;
  std::uint32_t nonce = 0;  ///< comes back: whose reply this is
};

struct OpenReply {
  std::uint8_t version_major = kProtocolMajor;
  std::uint8_t version_minor = kProtocolMinor;  ///< the smaller one of both sides
  std::uint16_t session = 0;                    ///< for the header of all that follows
  std::uint32_t nonce = 0;
  std::uint32_t board_time_us = 0;
};

/// Proof that the host has heard the board a moment ago, not only that bytes come in: without it a
/// queue of old heartbeats would keep a dead link alive.
struct HeartbeatRequest {
  std::uint32_t board_time_us = 0;  ///< the newest that the host has seen
};

struct HeartbeatReply {
  std::uint32_t board_time_us = 0;
  std::uint32_t age_us = 0;  ///< of the request's board_time_us when it came in
};

// --- Capabilities, state, control ------------------------------------------------------------

struct CapabilitiesReply {
  float rate_hz = 0.0F;
  float force_max_N = 0.0F;          ///< as set now
  float force_limit_N = 0.0F;        ///< greatest that kSetLimits takes
  float slew_N_s = 0.0F;             ///< as set now
  float slew_limit_N_s = 0.0F;       ///< greatest that kSetLimits takes
  float host_force_max_N = 0.0F;     ///< longest that kAddForce takes
  float stiffness_N_m = 0.0F;        ///< as set now
  float stiffness_limit_N_m = 0.0F;  ///< with a light hand
  std::uint32_t bodies_max = 0;
  std::uint32_t bodies = 0;           ///< there are: bit n is body n
  std::uint32_t slots = 0;            ///< for models; 0: the model is part of the image
  std::uint32_t slot_bytes = 0;       ///< most bytes of a model
  std::uint32_t flags = 0;            ///< BoardFlag
  std::uint32_t trace_ticks = 0;      ///< that the flight recorder holds
  std::uint32_t parameters = 0;       ///< number of them
  std::uint32_t cycles_per_tick = 0;  ///< of the core's clock in a period; 0: not known
};

enum class BoardFlag : std::uint32_t {
  kSignatureRequired = 1U << 0,  ///< a model must be signed
  kDeadManRequired = 1U << 1,    ///< a dead-man control confirms; else the message confirm
  kLinkRequired = 1U << 2,       ///< this session dies with its link
  kHomed = 1U << 3,
};

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
  kConfirm = 2,  ///< armed to active, with that token; where a hand confirms: refused
  kStop = 3,     ///< at any time, of any session and sequence number
  kClearFault = 4,
  kHome = 5,  ///< the device is in its home pose
};

struct ControlRequest {
  std::uint8_t code = 0;  ///< ControlCode
  std::uint8_t reserved[3] = {};
  std::uint32_t token = 0;  ///< kConfirm: from the reply to kArm; else 0
};

struct ControlReply {
  std::uint8_t state = 0;  ///< State after the tick that took it
  std::uint8_t reserved[3] = {};
  std::uint32_t faults = 0;
  std::uint32_t token = 0;  ///< of kArm
};

// --- What the hand feels ---------------------------------------------------------------------

struct SetLimitsRequest {
  float force_max_N = 0.0F;  ///< 0.01 .. the board's own
  float slew_N_s = 0.0F;     ///< up to the board's own
  float ramp_s = 0.0F;       ///< 2 ticks .. 10 s
};

struct SetMaterialRequest {
  float stiffness_N_m = 0.0F;
  float damping_Ns_m = 0.0F;
  float static_friction = 0.0F;
  float dynamic_friction = 0.0F;
  std::uint32_t use_materials = 1;  ///< 1: where the model has materials of its own they count
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
  float force_N[3] = {};          ///< device's axes; longer than the limit: scaled down to it
  std::uint32_t duration_ms = 0;  ///< 1 .. 100: then it is gone unless there was another
};

// --- Telemetry -------------------------------------------------------------------------------

/// Fields of a telemetry message, in this order, the ones that were asked for.
enum class TelemetryField : std::uint32_t {
  kState = 1U << 0,      ///< u32 State, u32 faults, u32 limits
  kProbe = 1U << 1,      ///< f32[3] m
  kVelocity = 1U << 2,   ///< f32[3] m/s
  kForce = 1U << 3,      ///< f32[3] N, that the hand feels
  kProxy = 1U << 4,      ///< f32[3] m
  kNormal = 1U << 5,     ///< f32[3]
  kContact = 1U << 6,    ///< f32 penetration m, u32 body, f32 share of the force displayed
  kWanted = 1U << 7,     ///< f32[3] N, before the gate
  kTiming = 1U << 8,     ///< u32 overruns, f32 share of the period that the last tick took
  kReactions = 1U << 9,  ///< twice: u32 body, f32[3] force N, f32[3] torque Nm
};
inline constexpr std::uint32_t kTelemetryFields = 10;

/// Bytes of each field, in the order above.
inline constexpr std::uint32_t kTelemetryFieldBytes[kTelemetryFields] = {12, 12, 12, 12, 12,
                                                                         12, 12, 12, 8,  56};

struct SubscribeRequest {
  std::uint32_t fields = 0;      ///< TelemetryField, or of them
  std::uint32_t decimation = 0;  ///< a message every so many ticks; 0: none
};

struct TelemetryHeader {
  std::uint32_t tick = 0;
  std::uint32_t board_time_us = 0;
  std::uint32_t fields = 0;   ///< that follow
  std::uint32_t dropped = 0;  ///< messages since the subscription that found no room
};

// --- Model store -----------------------------------------------------------------------------

enum class SlotState : std::uint8_t {
  kEmpty = 0,
  kPartial = 1,  ///< a transfer was begun and not finished
  kReady = 2,    ///< checked, not in use
  kActive = 3,   ///< in use, or will be after the next start
  kDamaged = 4,  ///< what it holds is not what was checked
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
  std::uint32_t counter_min = 0;  ///< a signed model with a smaller one is refused
  std::uint32_t slots = 0;
  ModelSlot slot[2]{};
};

/// What a signature covers, followed by the bytes of the model.
struct ModelManifest {
  char purpose[16] = {'t', 'a', 'c', 't', 'r', 'e', 'e', '-', 'm', 'o', 'd', 'e', 'l', '-', '1', 0};
  char board[24] = {};        ///< the only one that may use it, zero-terminated; empty: any
  std::uint32_t counter = 0;  ///< anti-rollback: never smaller than that of any model used before
  std::uint32_t bytes = 0;
};

struct BeginModelRequest {
  char board[24] = {};         ///< as in ModelManifest
  std::uint32_t counter = 0;   ///< as in ModelManifest
  std::uint32_t bytes = 0;     ///< of the whole model
  std::uint32_t checksum = 0;  ///< CRC-32 of all bytes
};

struct BeginModelReply {
  std::uint32_t slot = 0;
};

/// Followed by 1 .. kMaxPiece bytes, a multiple of 4 but for the last piece.
struct WriteModelRequest {
  std::uint32_t offset = 0;
};
inline constexpr std::uint32_t kMaxPiece = 256;

/// Also where the piece was out of order: the one place to go on from.
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
  std::uint32_t age = 0;    ///< of the first record: 0 is the newest
  std::uint32_t count = 0;  ///< 1 .. kMaxTraceRecords, going back in time
};

/// Followed by `count` records of 18 bytes (FlightRecord).
struct ReadTraceReply {
  std::uint32_t last_tick = 0;  ///< of the newest record
  std::uint32_t total = 0;      ///< records that there are
  std::uint32_t age = 0;
  std::uint32_t count = 0;  ///< may be less than asked for
};
inline constexpr std::uint32_t kMaxTraceRecords = 13;

struct ReadFaultReply {
  std::uint32_t faults = 0;  ///< 0: there was none
  std::uint32_t tick = 0;
  float probe_m[3] = {};
  float proxy_m[3] = {};
  float velocity_m_s[3] = {};
  float force_N[3] = {};
};

/// Parts of a board that did not start; with any of them there is no force.
enum class StartPart : std::uint32_t {
  kEncoders = 1U << 0,
  kMotors = 1U << 1,
  kEnableLine = 1U << 2,
  kSafetyInputs = 1U << 3,
  kWatchdog = 1U << 4,          ///< or it did not take its time back after the flash was erased
  kReceiver = 1U << 5,          ///< of the link: what comes fast is lost
  kCrystal = 1U << 8,           ///< no oscillation: the core is slow
  kCrystalFrequency = 1U << 9,  ///< another crystal than the board's
  kWaitStates = 1U << 10,       ///< of the flash
  kPll = 1U << 11,              ///< does not lock
  kClockSwitch = 1U << 12,      ///< the core stays on its internal oscillator
};

/// The first four: why there is no model; 0 is good.
struct ReadStartReply {
  std::uint8_t configuration = 0;   ///< ConfigurationStatus
  std::uint8_t blob = 0;            ///< BlobStatus
  std::uint8_t model = 0;           ///< ModelStatus
  std::uint8_t image = 0;           ///< 1: a byte of the program is wrong; 2: a bit of RAM
  std::uint32_t missing = 0;        ///< StartPart, or of them
  std::uint32_t by_watchdog = 0;    ///< 1: it caused the last reset
  std::uint32_t fault_cause = 0;    ///< what the last run died of; 0: nothing; see CapturedFault
  std::uint32_t fault_status = 0;   ///< Arm: CFSR; RISC-V: mstatus
  std::uint32_t fault_address = 0;  ///< Arm: BFAR or MMFAR; RISC-V: mtval
  std::uint32_t fault_pc = 0;       ///< instruction that failed, or one soon after it
  std::uint32_t fault_lr = 0;       ///< return address
  std::uint32_t fault_sp = 0;       ///< stack pointer
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
