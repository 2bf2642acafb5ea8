// Promise P4: skipping any single instruction of the gate and of the path to force gives no force
// while stopped. skip_test.py lists the instructions; this program replaces one at a time by a
// no-op, runs the control loop from several stopped states and checks the commands to the motors.
// Its code runs in RAM.
//
// Each line of the output is the address of an instruction and the outcome. A fault or hang ends in
// a reset, after which motors are off; the emulator ends there, and skip_test.py continues after
// that instruction.

#include <cstring>
#include <type_traits>

#include "check.hpp"
#include "golden_blobs.hpp"
#include "plant_link/semihosting.hpp"
#include "platform.hpp"
#include "tactree/hal/loop.hpp"

namespace tactree::test {

void print(const char* text) { firmware::semihosting::print(text); }

namespace {

using core::Command;
using core::State;

/// Every part of a board in one, driven by the campaign.
class Bench {
 public:
  Bench& encoders() { return *this; }
  Bench& motors() { return *this; }
  Bench& enable_line() { return *this; }
  Bench& safety_inputs() { return *this; }
  Bench& ticker() { return *this; }
  Bench& link() { return *this; }
  Bench& storage() { return *this; }

  [[nodiscard]] core::EncoderReading read() noexcept { return counts; }
  // Not inlined: the check of commands is not part of the skipped code.
  [[gnu::noinline]] void write(const core::MotorCommand& efforts) noexcept {
    told = false;
    for (std::uint32_t i = 0; i < core::kAxes; ++i) {  // bound: kAxes
      std::uint32_t bits;
      const float effort = efforts.effort(i);
      std::memcpy(&bits, &effort, sizeof bits);
      told = told || (bits << 1) != 0U;  // anything but a zero, NaN included
    }
    commanded = commanded || told;
  }
  [[nodiscard]] bool healthy() noexcept { return true; }
  void set(bool on) noexcept { enabled = on; }
  [[nodiscard]] bool read_back() noexcept { return enabled; }
  [[nodiscard]] bool emergency_stop() noexcept { return stopped; }
  [[nodiscard]] bool dead_man() noexcept { return held; }
  [[nodiscard]] hal::Tick wait() noexcept { return {}; }
  [[nodiscard]] std::uint32_t now_us() noexcept { return 0; }
  [[nodiscard]] hal::LinkInput receive() noexcept { return {true, command, {}}; }
  void send(const core::Status&) noexcept {}
  [[nodiscard]] std::span<const std::byte> active() const noexcept {
    return golden(Golden::kSurface);
  }

  core::EncoderReading counts{};
  Command command = Command::kNone;
  bool stopped = false;
  bool held = true;
  bool enabled = false;
  bool told = false;  ///< the last command is not zero
  // Since they were last cleared:
  bool commanded = false;  ///< a command was not zero
  bool force = false;      ///< and had power
};

Bench bench;
core::Controller controller;
hal::Loop<Bench> loop(bench, controller);
static_assert(std::is_trivially_copyable_v<core::Controller>);

void tick(Command command) {
  bench.command = command;
  (void)loop.tick();
  bench.force = bench.force || (bench.told && bench.enabled);
}

// ---- where the session stands, kept and brought back

struct Kept {
  alignas(core::Controller) std::byte controller[sizeof(core::Controller)];
  Bench bench;
  std::byte after[sizeof(core::Controller)];  ///< a session with every instruction
};
enum : std::uint32_t { kNeverArmed, kStopped, kFaulted, kStarts };
Kept kept[kStarts];

void keep(Kept& here) {
  std::memcpy(here.controller, &controller, sizeof controller);
  here.bench = bench;
}

void bring_back(const Kept& there) {
  std::memcpy(static_cast<void*>(&controller), there.controller, sizeof controller);
  bench = there.bench;
  bench.force = false;
  bench.commanded = false;
}

void go_to(core::Vec3 place) {
  const core::DeviceModel& device = controller.configuration().device;
  const float at[core::kAxes] = {place.x, place.y, place.z};
  for (std::uint32_t i = 0; i < core::kAxes; ++i) {  // bound: kAxes
    bench.counts.counts[i] =
        static_cast<std::int32_t>(at[i] * device.counts_per_m[i]) + device.home_count[i];
    bench.counts.valid[i] = true;
  }
}

void move(const core::SurfacePoint& point, int from_mm, int to_mm) {
  const int step = from_mm < to_mm ? 1 : -1;
  for (int mm = from_mm; mm != to_mm; mm += step) {  // bound: 14
    go_to(point.position + (1e-3F * static_cast<float>(mm)) * point.normal);
    tick(Command::kNone);
  }
}

bool expect(bool good, const char* sentence) {
  if (!good) {
    print("not so: ");
    print(sentence);
    print("\n");
  }
  return good;
}

void activate(const core::SurfacePoint& point) {
  move(point, -3, 11);
  bench.held = false;
  tick(Command::kArm);
  tick(Command::kNone);
  bench.held = true;
  tick(Command::kNone);
  move(point, 10, -4);
}

/// Every start is a hand that presses into the object and holds the dead-man control.
bool prepare() {
  core::Configuration configuration;
  configuration.device.homing = core::HomingMethod::kAbsolute;
  configuration.limits.ramp_s = 0.002F;  // as soon as can be: a mistake is to show
  if (!expect(loop.start(configuration).ok(), "the model is loaded")) {
    return false;
  }
  core::BlobView view;
  (void)core::open_blob(golden(Golden::kSurface), view);
  const core::LeafCursor cursor(view);
  const core::SurfacePoint point =
      view.surface_point(cursor.leaf(), cursor.leaf().first_point + cursor.leaf().point_count / 2U);

  move(point, 10, -4);
  bool good = expect(!bench.commanded && controller.state() == State::kIdle, "idle has no force");
  keep(kept[kNeverArmed]);

  activate(point);
  good &= expect(bench.force && controller.state() == State::kActive, "a session gives force");
  tick(Command::kStop);
  bench.commanded = false;
  tick(Command::kNone);
  good &= expect(!bench.commanded && controller.state() == State::kIdle, "stop ends it");
  keep(kept[kStopped]);

  activate(point);
  bench.stopped = true;
  tick(Command::kNone);
  bench.commanded = false;
  tick(Command::kNone);
  good &=
      expect(!bench.commanded && controller.state() == State::kFault, "the emergency stop, too");
  keep(kept[kFaulted]);
  return good;
}

// ---- one instruction after the other

struct Instruction {
  std::uint32_t address;
  std::uint32_t bytes;
};
constexpr std::uint32_t kInstructionsMax = 16384;
Instruction instructions[kInstructionsMax];

volatile std::uint32_t periods = 0;        // of the tick interrupt, in this run
constexpr std::uint32_t kPeriodsMax = 16;  // beyond: it hangs

std::uint32_t read_list() {
  const int file =
      firmware::semihosting::open("instructions", firmware::semihosting::Access::kRead);
  std::uint32_t count = 0;
  const auto bytes = std::as_writable_bytes(std::span(&count, 1));
  if (file < 0 || !firmware::semihosting::read(file, bytes) || count > kInstructionsMax ||
      !firmware::semihosting::read(file, std::as_writable_bytes(std::span(instructions, count)))) {
    return 0;
  }
  return count;
}

void synchronise() { __asm volatile("dsb\n\tisb" ::: "memory"); }

void write_code(const Instruction& place, const std::uint16_t (&halves)[2]) {
  auto* code = reinterpret_cast<volatile std::uint16_t*>(place.address);
  for (std::uint32_t i = 0; i < place.bytes / 2U; ++i) {  // bound: 2
    code[i] = halves[i];
  }
  synchronise();
}

/// A stopped session with the instruction left out for some ticks, and as it goes on after them.
void session(const Kept& start, const Instruction& place) {
  bring_back(start);
  const auto* code = reinterpret_cast<const std::uint16_t*>(place.address);
  const std::uint16_t original[2] = {code[0], code[1]};
  constexpr std::uint16_t kNarrow[2] = {0xBF00, 0xBF00};
  constexpr std::uint16_t kWide[2] = {0xF3AF, 0x8000};
  if (place.bytes != 0U) {
    write_code(place, place.bytes == 2U ? kNarrow : kWide);
  }
  for (const Command command : {Command::kNone, Command::kStop, Command::kNone, Command::kNone}) {
    tick(command);
  }
  write_code(place, original);
  for (int i = 0; i < 4; ++i) {  // bound: 4
    tick(Command::kNone);
  }
}

/// Outcome of the session without this instruction.
const char* outcome(const Instruction& place) {
  const char* result = "same\n";
  for (const Kept& start : kept) {  // bound: kStarts
    session(start, place);
    if (bench.force) {
      return "force\n";
    }
    if (bench.commanded) {
      result = "command\n";
    } else if (std::memcmp(&controller, start.after, sizeof controller) != 0) {
      result = result[0] == 'c' ? result : "other\n";
    }
  }
  return result;
}

int run() {
  const std::uint32_t count = read_list();
  if (!expect(count > 0, "the list of instructions is there") || !prepare()) {
    return 1;
  }
  for (Kept& start : kept) {  // bound: kStarts
    session(start, {instructions[0].address, 0});
    std::memcpy(start.after, &controller, sizeof controller);
  }
  firmware::start_ticks(1000.0F);
  for (const Instruction& place : std::span(instructions, count)) {  // bound: kInstructionsMax
    print_number(place.address);
    print(" ");
    periods = 0;
    print(outcome(place));
  }
  print("end\n");
  return 0;
}

}  // namespace
}  // namespace tactree::test

void tactree_tick() {
  using namespace tactree;
  test::periods = test::periods + 1U;
  if (test::periods > test::kPeriodsMax) {
    firmware::reset();  // what a watchdog does
  }
}

int main() {
  (void)tactree::firmware::take_captured_fault();
  tactree::firmware::semihosting::exit(static_cast<std::uint32_t>(tactree::test::run()));
}
