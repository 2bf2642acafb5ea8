#include "tactree/emulation/emulated_target.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>

#include <cstring>
#include <sstream>
#include <vector>

#include "find_files.hpp"
#include "serial_bridge.hpp"
#include "tactree/hal/plant_link.hpp"
#include "tactree/support/child_process.hpp"
#include "tactree/support/high_descriptor.hpp"

namespace tactree::emulation {
namespace {

namespace link = hal::plant_link;
using std::chrono::milliseconds;
using support::ChildProcess;
using support::HighDescriptor;
using support::Pipe;

// Descriptor numbers in the emulator; the first two are those of plant_link.hpp.
constexpr int kToBoard = 3;
constexpr int kFromBoard = 4;
constexpr int kCounts = 5;
constexpr int kBlob = 6;
constexpr int kSerial = 7;

constexpr milliseconds kEndLimit{10'000};

[[noreturn]] void fail_with_errno(const std::string& what) {
  throw EmulationError(what + ": " + std::strerror(errno));
}

Pipe make_pipe() {
  try {
    return support::make_pipe();
  } catch (const std::system_error& error) {
    throw EmulationError(std::string("emulation: ") + error.what());
  }
}

HighDescriptor make_memory_file(const char* name) {
  const int descriptor = ::memfd_create(name, MFD_CLOEXEC);
  if (descriptor < 0) {
    fail_with_errno(std::string("emulation: memory for the ") + name);
  }
  return HighDescriptor(descriptor);
}

void write_all(int descriptor, std::span<const std::byte> bytes, const std::string& what) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) {
      fail_with_errno(what);
    }
    bytes = bytes.subspan(written < 0 ? 0U : static_cast<std::size_t>(written));
  }
}

std::string read_to_end(int descriptor) {
  std::string text;
  char buffer[4096];
  ssize_t count = 0;
  while ((count = ::read(descriptor, buffer, sizeof buffer)) > 0) {
    text.append(buffer, static_cast<std::size_t>(count));
  }
  return text;
}

/// Waits for input for at most `limit`. A signal such as Ctrl-C restarts the wait.
bool readable(int descriptor, milliseconds limit) {
  pollfd wanted{descriptor, POLLIN, 0};
  int found = -1;
  do {
    found = ::poll(&wanted, 1, static_cast<int>(limit.count()));
  } while (found < 0 && errno == EINTR);
  return found > 0;
}

/// Doubles commas, which separate options of the emulator.
std::string quoted(const std::string& path) {
  std::string doubled;
  for (const char letter : path) {
    doubled.append(letter == ',' ? 2U : 1U, letter);
  }
  return doubled;
}

std::vector<std::string> command_line(const BoardDescription& board, const std::string& program,
                                      const std::filesystem::path& image,
                                      const EmulationOptions& options) {
  std::vector<std::string> line{program};
  std::istringstream machine(board.machine);
  for (std::string word; machine >> word;) {
    line.push_back(word);
  }
  const std::string counter =
      fmt::format("file={},out=/dev/fd/{},skip={}{}", quoted(find_counter().string()), kCounts,
                  options.uncounted_ticks, options.note_code ? ",code=on" : "");
  for (const std::string& word :
       {std::string("-nodefaults"), std::string("-display"), std::string("none"),
        std::string("-semihosting-config"), std::string("enable=on,target=native"),
        std::string("-icount"),
        fmt::format("shift={},sleep=off",
                    options.instruction_shift.value_or(board.instruction_shift)),
        std::string("-kernel"), image.string(), std::string("-device"),
        fmt::format("loader,file=/dev/fd/{},addr={:#x},force-raw=on", kBlob, board.blob_address)}) {
    line.push_back(word);
  }
  if (options.served != nullptr) {
    for (const std::string& word :
         {std::string("-chardev"), fmt::format("socket,id=application,fd={}", kSerial),
          std::string("-serial"), std::string("chardev:application")}) {
      line.push_back(word);
    }
  }
  if (options.count_instructions) {
    line.push_back("-plugin");
    line.push_back(counter);
  }
  return line;
}

std::string describe(const hal::CapturedFault& f) {
  return fmt::format(
      "fault {} at pc {:#010x}, lr {:#010x}, sp {:#010x}, status {:#010x}, address {:#010x}",
      f.cause, f.pc, f.lr, f.sp, f.status, f.address);
}

}  // namespace

class EmulatedTarget::Session {
 public:
  Session(const BoardDescription& board, std::span<const std::byte> blob,
          const EmulationOptions& options)
      : board_(board), options_(options) {
    check_size(blob);
    const std::string program = support::find_program(board.emulator);
    if (program.empty()) {
      throw EmulationError(fmt::format("board {}: the emulator {} is missing (apt-get install {})",
                                       board.name, board.emulator, board.package));
    }
    const std::filesystem::path image = options.image.empty() ? find_image(board) : options.image;
    write_all(blob_.get(), blob, "the blob for the emulator");
    std::vector<std::pair<int, int>> inherited{{to_board_.read_end.get(), kToBoard},
                                               {from_board_.write_end.get(), kFromBoard},
                                               {counts_.write_end.get(), kCounts},
                                               {blob_.get(), kBlob}};
    if (options.served != nullptr) {
      bridge_.emplace(*options.served);
      inherited.emplace_back(bridge_->board_end(), kSerial);
    }
    process_.emplace(command_line(board, program, image, options),
                     support::Streams{log_.get(), log_.get(), inherited});
    // Only the emulator keeps the write ends of these pipes, so that its end is their end of file.
    // The read end of to_board_ stays open here, because a write to an emulator that has ended must
    // not raise SIGPIPE.
    from_board_.write_end.close();
    counts_.write_end.close();
    greet();
  }

  hal::StartResult start(const core::Configuration& configuration) {
    link::SessionSetup message;
    message.configuration = configuration;
    message.served = options_.served != nullptr ? 1U : 0U;
    send(message);
    return receive<link::Started>(link::Kind::kStarted, options_.start_limit).result;
  }

  link::TickOutput exchange(const link::TickInput& message) {
    if (bridge_) {
      bridge_->move();
    }
    send(message);
    return receive<link::TickOutput>(link::Kind::kTickOutput, options_.tick_limit);
  }

  void finish() {
    link::TickInput message;
    message.kind = link::Kind::kFinish;
    send(message);
    std::string report;
    if (options_.count_instructions && readable(counts_.read_end.get(), kEndLimit)) {
      report = read_to_end(counts_.read_end.get());
    }
    if (!process_->wait(kEndLimit)) {
      throw EmulationError(fmt::format("board {}: the emulator does not terminate", board_.name));
    }
    if (!process_->succeeded()) {
      throw EmulationError(ended());
    }
    if (options_.count_instructions) {
      instruction_counts = parse_instruction_counts(report);
    }
  }

  std::optional<InstructionCounts> instruction_counts;

 private:
  void check_size(std::span<const std::byte> blob) const {
    if (blob.size() > board_.blob_bytes_max) {
      throw EmulationError(fmt::format(
          "board {}: the blob has {} bytes, the board has room for {} (build it with a larger "
          "--spacing, or with --flash-budget {})",
          board_.name, blob.size(), board_.blob_bytes_max, board_.blob_bytes_max));
    }
  }

  void greet() {
    const auto hello = receive<link::Hello>(link::Kind::kHello, options_.start_limit);
    const std::string name(hello.board, ::strnlen(hello.board, sizeof hello.board));
    if (hello.version != link::kVersion ||
        hello.configuration_bytes != sizeof(core::Configuration) ||
        hello.status_bytes != sizeof(core::Status)) {
      throw EmulationError(
          fmt::format("board {}: its image was built with a different version of Tactree ({})",
                      board_.name, how_to_build(board_)));
    }
    if (name != board_.name || hello.blob_address != board_.blob_address ||
        hello.blob_bytes_max != board_.blob_bytes_max) {
      throw EmulationError(fmt::format("board {}: the image is for {} ({})", board_.name, name,
                                       how_to_build(board_)));
    }
  }

  template <class Message>
  void send(const Message& message) {
    write_all(to_board_.write_end.get(), std::as_bytes(std::span(&message, 1)),
              fmt::format("board {}", board_.name));
  }

  template <class Message>
  Message receive(link::Kind expected, milliseconds limit) {
    Message message;
    const std::span<std::byte> bytes = std::as_writable_bytes(std::span(&message, 1));
    receive_bytes(bytes.first(sizeof expected), limit);
    if (message.kind == link::Kind::kHello && expected != link::Kind::kHello) {
      report_restart(limit);
    }
    if (message.kind != expected) {
      throw EmulationError(fmt::format("board {}: unexpected message {:#x}, expected {:#x}",
                                       board_.name, static_cast<std::uint32_t>(message.kind),
                                       static_cast<std::uint32_t>(expected)));
    }
    receive_bytes(bytes.subspan(sizeof expected), limit);
    return message;
  }

  // A hello message during the session means that the board has reset.
  [[noreturn]] void report_restart(milliseconds limit) {
    link::Hello hello;
    receive_bytes(std::as_writable_bytes(std::span(&hello, 1)).subspan(sizeof hello.kind), limit);
    throw EmulationError(fmt::format(
        "board {}: restarted unexpectedly: {}", board_.name,
        hello.last_fault.present() ? describe(hello.last_fault) : "no fault was recorded"));
  }

  void receive_bytes(std::span<std::byte> bytes, milliseconds limit) {
    while (!bytes.empty()) {
      if (!readable(from_board_.read_end.get(), limit)) {
        throw EmulationError(fmt::format("board {}: no message for {} s", board_.name,
                                         static_cast<double>(limit.count()) / 1e3));
      }
      const ssize_t count = ::read(from_board_.read_end.get(), bytes.data(), bytes.size());
      if (count == 0) {
        throw EmulationError(ended());
      }
      if (count < 0 && errno != EINTR) {
        fail_with_errno(fmt::format("board {}", board_.name));
      }
      bytes = bytes.subspan(count < 0 ? 0U : static_cast<std::size_t>(count));
    }
  }

  [[nodiscard]] std::string ended() {
    const std::string how = process_->wait(kEndLimit) ? process_->ending() : "no answer";
    ::lseek(log_.get(), 0, SEEK_SET);
    std::string log = read_to_end(log_.get());
    while (!log.empty() && log.back() == '\n') {
      log.pop_back();
    }
    return fmt::format("board {}: the emulator terminated unexpectedly: {}{}{}", board_.name, how,
                       log.empty() ? "" : ": ", log);
  }

  const BoardDescription& board_;
  EmulationOptions options_;
  Pipe to_board_ = make_pipe();
  Pipe from_board_ = make_pipe();
  Pipe counts_ = make_pipe();
  HighDescriptor blob_ = make_memory_file("blob");
  HighDescriptor log_ = make_memory_file("log");
  std::optional<SerialBridge> bridge_;
  std::optional<ChildProcess> process_;
};

EmulatedTarget::EmulatedTarget(const BoardDescription& board, std::span<const std::byte> blob,
                               const EmulationOptions& options)
    : session_(std::make_unique<Session>(board, blob, options)) {}

EmulatedTarget::~EmulatedTarget() = default;

hal::StartResult EmulatedTarget::start(hal::sim::SimBoard& board,
                                       const core::Configuration& configuration) {
  board.enable_line().set(false);
  return session_->start(configuration);
}

// The counterpart of hal::Loop::tick(), with the controller at the other end of the link.
core::Status EmulatedTarget::tick(hal::sim::SimBoard& board) {
  link::TickInput message;
  const core::Input input = hal::read_inputs(board);
  const core::Readings& readings = input;  // without what the link adds
  message.input = readings;
  const hal::LinkInput received = board.link().take_message();
  message.input.link_alive = received.alive;
  message.input.command = received.command;
  message.body = received.bodies.empty() ? hal::BodyUpdate{} : received.bodies.front();
  message.arm_button = board.panel().is_pressed();

  const link::TickOutput output = session_->exchange(message);
  board.motors().hold(output.effort);
  board.enable_line().set(output.enable);
  board.panel().light(output.lamp);
  return output.status;
}

void EmulatedTarget::finish() { session_->finish(); }

const std::optional<InstructionCounts>& EmulatedTarget::instruction_counts() const {
  return session_->instruction_counts;
}

}  // namespace tactree::emulation
