// Loop and memory annotations: docs/BOUND.md.

#include "plant_link/plant_link_board.hpp"

#include <cstddef>
#include <span>

#include "plant_link/semihosting.hpp"
#include "runtime/identity.hpp"
#include "runtime/image.hpp"

namespace tactree::firmware {
namespace {

namespace link = hal::plant_link;

// Exit codes of the emulation.
constexpr std::uint32_t kFinished = 0;
constexpr std::uint32_t kNoHost = 3;  // the streams are missing or ended before kFinish

template <class Message>
void send_message(int file, const Message& message) {
  if (!semihosting::write(file, std::as_bytes(std::span(&message, 1)))) {
    semihosting::exit(kNoHost);
  }
}

template <class Message>
void receive_message(int file, Message& message) {
  if (!semihosting::read(file, std::as_writable_bytes(std::span(&message, 1)))) {
    semihosting::exit(kNoHost);
  }
}

}  // namespace

core::Configuration PlantLinkBoard::connect(const hal::CapturedFault& last_fault) {
  from_host_ = semihosting::open(link::kToBoard, semihosting::Access::kRead);
  to_host_ = semihosting::open(link::kFromBoard, semihosting::Access::kWrite);
  if (from_host_ < 0 || to_host_ < 0) {
    semihosting::exit(kNoHost);
  }
  link::Hello hello;
  hello.blob_address = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(blob_begin));
  hello.blob_bytes_max = static_cast<std::uint32_t>(blob_end - blob_begin);
  for (std::uint32_t i = 0; i + 1U < sizeof hello.board; ++i) {  // bound: 23
    hello.board[i] = kIdentity.board[i];
  }
  hello.last_fault = last_fault;
  send_message(to_host_, hello);

  link::SessionSetup session;
  receive_message(from_host_, session);
  served_ = session.served != 0U;
  panel_.configure(session.configuration.rate_hz);
  return session.configuration;
}

void PlantLinkBoard::report(const hal::StartResult& result) {
  link::Started started;
  started.result = result;
  send_message(to_host_, started);
}

hal::Tick PlantLinkBoard::Ticker::wait() noexcept {
  const std::uint32_t missed = deadline_.wait();
  board_.exchange();
  return {missed + board_.input_.input.overruns};
}

void PlantLinkBoard::exchange() {
  if (in_session_) {
    send_message(to_host_, output_);
  }
  in_session_ = true;
  receive_message(from_host_, input_);
  if (input_.kind != link::Kind::kTickInput) {
    semihosting::exit(kFinished);
  }
}

void PlantLinkBoard::write(const core::MotorCommand& command) noexcept {
  for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {  // bound: kAxes
    output_.effort[axis] = command.effort(axis);
  }
}

hal::LinkInput PlantLinkBoard::take_message() noexcept {
  const std::size_t bodies = input_.body.body != core::kNoBody ? 1U : 0U;
  const hal::LinkInput received{
      input_.input.link_alive, input_.input.command, 0, {&input_.body, bodies}, {}, false};
  input_.input.link_alive = false;
  input_.input.command = core::Command::kNone;
  return received;
}

void PlantLinkBoard::operate(hal::LinkInput& input) noexcept {
  panel_.operate(input_.arm_button, input);
}

void PlantLinkBoard::send(const core::Status& status) noexcept {
  output_.status = status;
  output_.lamp = panel_.lamp(status);
}

}  // namespace tactree::firmware
