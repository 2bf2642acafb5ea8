#include "plant_link/plant_link_board.hpp"

#include "plant_link/semihosting.hpp"
#include "runtime/image.hpp"
#include "tactree/core/blob_format.hpp"

namespace tactree::firmware {
namespace {

namespace link = hal::plant_link;

// Exit codes of the emulation.
constexpr std::uint32_t kFinished = 0;
constexpr std::uint32_t kNoHost = 3;  // the streams are missing, or ended before kFinish

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
  for (std::uint32_t i = 0; i + 1U < sizeof hello.board && kBoardName[i] != 0; ++i) {  // bound: 23
    hello.board[i] = kBoardName[i];
  }
  hello.last_fault = last_fault;
  send_message(to_host_, hello);

  link::Session session;
  receive_message(from_host_, session);
  return session.configuration;
}

void PlantLinkBoard::report(const hal::StartResult& result) {
  link::Started started;
  started.result = result;
  send_message(to_host_, started);
}

hal::Tick PlantLinkBoard::Ticker::wait() noexcept {
  while (deadlines() == seen_) {  // bound: 0 (a deadline has begun this tick)
    wait_for_interrupt();
  }
  const std::uint32_t now = deadlines();
  const std::uint32_t missed = now - seen_ - 1U;
  seen_ = now;
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

hal::LinkInput PlantLinkBoard::receive() noexcept {
  const hal::LinkInput received{input_.input.link_alive, input_.input.command};
  input_.input.link_alive = false;
  input_.input.command = core::Command::kNone;
  return received;
}

// The header tells the size; open_blob() finds out when that is a lie.
std::span<const std::byte> PlantLinkBoard::active() const noexcept {
  const auto area = static_cast<std::size_t>(blob_end - blob_begin);
  const auto& header = *reinterpret_cast<const core::BlobHeader*>(blob_begin);
  return {blob_begin, header.total_bytes < area ? header.total_bytes : area};
}

}  // namespace tactree::firmware
