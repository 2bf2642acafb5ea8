// GpioLines with libgpiod 1.6: each line with edges has a separate queue of 16 edges. When a queue
// is full, the kernel drops the newest edge and does not report it.
//
// Loop and memory annotations: docs/BOUND.md.

#include <fcntl.h>
#include <gpiod.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "edge_order.hpp"
#include "gpio_chip.hpp"
#include "interrupt_counter.hpp"
#include "monotonic_time.hpp"

namespace tactree::hal::linux_gpio {
namespace {

constexpr int kQueue = 16;  // edges in the kernel's queue of each line

struct CloseChip {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }
};
using OpenChip = std::unique_ptr<gpiod_chip, CloseChip>;

int flags_of(const InputSettings& settings) {
  int flags = settings.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  flags |= settings.bias == Bias::kPullUp ? GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP : 0;
  flags |= settings.bias == Bias::kPullDown ? GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN : 0;
  return flags;
}

/// Returns the interrupt that was added by a request.
std::string added(const std::set<std::string>& before, const std::set<std::string>& after,
                  const std::string& name) {
  std::vector<std::string> fresh;
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                      std::back_inserter(fresh));
  if (fresh.size() != 1U) {
    throw GpioError("line '" + name +
                    "': its interrupt is not in /sys/kernel/irq, which libgpiod 1.6 needs to "
                    "detect lost edges (hint: libgpiod 2.x, or a kernel with CONFIG_SPARSE_IRQ)");
  }
  return fresh.front();
}

}  // namespace

struct GpioLines::Request {
  explicit Request(const WantedLines& wanted);
  void request_values(const WantedLines& wanted, const gpiod_line_request_config& config);
  void request_edges(const WantedLines& wanted, const gpiod_line_request_config& config);
  void count_interrupts() noexcept;
  [[nodiscard]] int read_queue(std::size_t line) noexcept;
  [[nodiscard]] bool look() noexcept;

  OpenChip chip;
  gpiod_line_bulk bulk = GPIOD_LINE_BULK_INITIALIZER;
  std::vector<InterruptCounter> counters;  // of lines with edges
  std::vector<std::uint32_t> interrupts;
  EdgeOrder order;
  std::array<gpiod_line_event, kQueue> events{};
};

GpioLines::Request::Request(const WantedLines& wanted)
    : chip(gpiod_chip_open(wanted.chip().c_str())), order(wanted.names.size()) {
  if (!chip) {
    refuse(wanted, errno);
  }
  for (const LinePlace& place : wanted.places) {  // bound: kMaxLines
    gpiod_line* const line = gpiod_chip_get_line(chip.get(), place.offset);
    if (line == nullptr) {
      refuse(wanted, errno);
    }
    gpiod_line_bulk_add(&bulk, line);
  }
}

void GpioLines::Request::request_values(const WantedLines& wanted,
                                        const gpiod_line_request_config& config) {
  const std::array<int, kMaxLines> off{};
  if (gpiod_line_request_bulk(&bulk, &config, off.data()) != 0) {
    refuse(wanted, errno);
  }
}

// Lines are requested one after the other, so the new interrupt is that of the line.
void GpioLines::Request::request_edges(const WantedLines& wanted,
                                       const gpiod_line_request_config& config) {
  for (unsigned int i = 0; i < bulk.num_lines; ++i) {  // bound: kMaxLines
    const std::set<std::string> before = interrupts_of(wanted.consumer);
    gpiod_line* const line = bulk.lines[i];
    if (gpiod_line_request(line, &config, 0) != 0) {
      refuse(wanted, errno);
    }
    const int file = gpiod_line_event_get_fd(line);
    (void)fcntl(file, F_SETFL, fcntl(file, F_GETFL) | O_NONBLOCK);
    counters.emplace_back(added(before, interrupts_of(wanted.consumer), wanted.names[i]));
  }
  interrupts.resize(counters.size());
}

void GpioLines::Request::count_interrupts() noexcept {
  for (std::size_t i = 0; i < counters.size(); ++i) {  // bound: kMaxLines
    interrupts[i] = counters[i].read();
  }
}

/// Fills `events` and returns their number, or -1 if the chip was removed.
int GpioLines::Request::read_queue(std::size_t line) noexcept {
  const int count = gpiod_line_event_read_multiple(bulk.lines[line], events.data(), kQueue);
  return count < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : count;
}

/// Moves all edges from the queues into `order`. Returns false if the chip was removed.
bool GpioLines::Request::look() noexcept {
  const std::uint64_t begin_ns = linux_time::now_ns();
  count_interrupts();
  order.look(begin_ns, linux_time::now_ns(), interrupts);
  for (std::size_t line = 0; line < counters.size(); ++line) {  // bound: kMaxLines
    const int count = read_queue(line);
    if (count < 0) {
      return false;
    }
    for (int i = 0; i < count; ++i) {  // bound: kQueue
      const gpiod_line_event& event = events[static_cast<std::size_t>(i)];
      order.add({linux_time::to_ns(event.ts), static_cast<std::uint32_t>(line),
                 event.event_type == GPIOD_LINE_EVENT_RISING_EDGE});
    }
    if (count == kQueue) {
      order.overflowed();
    }
  }
  order.settle();
  return true;
}

GpioLines::GpioLines(std::unique_ptr<Request> request) : request_(std::move(request)) {}
GpioLines::~GpioLines() = default;
GpioLines::GpioLines(GpioLines&&) noexcept = default;

GpioLines GpioLines::inputs(const std::vector<std::string>& names, const std::string& consumer,
                            const InputSettings& settings) {
  const WantedLines wanted = find_lines(names, consumer);
  auto request = std::make_unique<Request>(wanted);
  gpiod_line_request_config config{};
  config.consumer = wanted.consumer.c_str();
  config.flags = flags_of(settings);
  config.request_type =
      settings.edges ? GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES : GPIOD_LINE_REQUEST_DIRECTION_INPUT;
  if (!settings.edges) {
    request->request_values(wanted, config);
    return GpioLines(std::move(request));
  }
  request->request_edges(wanted, config);
  GpioLines lines(std::move(request));
  lines.await_rest(names.front());
  return lines;
}

GpioLines GpioLines::outputs(const std::vector<std::string>& names, const std::string& consumer,
                             bool active_low) {
  const WantedLines wanted = find_lines(names, consumer);
  auto request = std::make_unique<Request>(wanted);
  gpiod_line_request_config config{};
  config.consumer = wanted.consumer.c_str();
  config.flags = active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  config.request_type = GPIOD_LINE_REQUEST_DIRECTION_OUTPUT;
  request->request_values(wanted, config);
  return GpioLines(std::move(request));
}

bool GpioLines::levels(std::uint64_t& bits) const noexcept {
  std::array<int, kMaxLines> values;
  if (gpiod_line_get_value_bulk(&request_->bulk, values.data()) != 0) {
    return false;
  }
  bits = 0;
  for (std::size_t i = 0; i < request_->bulk.num_lines; ++i) {  // bound: kMaxLines
    bits |= static_cast<std::uint64_t>(values[i] != 0) << i;
  }
  return true;
}

bool GpioLines::set(std::uint64_t bits) noexcept {
  std::array<int, kMaxLines> values;
  for (std::size_t i = 0; i < request_->bulk.num_lines; ++i) {  // bound: kMaxLines
    values[i] = static_cast<int>((bits >> i) & 1U);
  }
  return gpiod_line_set_value_bulk(&request_->bulk, values.data()) == 0;
}

int GpioLines::read_edges(std::array<Edge, kEdgesAtOnce>& edges) noexcept {
  if (!request_->look()) {
    return -1;
  }
  int found = 0;
  while (found < static_cast<int>(kEdgesAtOnce) &&
         request_->order.take(edges[static_cast<std::size_t>(found)])) {  // bound: kEdgesAtOnce
    ++found;
  }
  return found;
}

std::uint64_t GpioLines::held() const { return request_->order.held(); }

std::uint32_t GpioLines::lost() const { return request_->order.lost(); }

void GpioLines::begin_edges() noexcept {
  for (std::size_t line = 0; line < request_->counters.size(); ++line) {  // bound: kMaxLines
    while (request_->read_queue(line) > 0) {  // bound: edges of the line while it is read
    }
  }
  request_->count_interrupts();
  request_->order.begin(request_->interrupts);
}

bool GpioLines::is_at_rest() noexcept {
  const std::vector<std::uint32_t> begin = request_->interrupts;
  request_->count_interrupts();
  bool rested = request_->interrupts == begin;
  for (std::size_t line = 0; line < request_->counters.size(); ++line) {  // bound: kMaxLines
    rested = request_->read_queue(line) <= 0 && rested;
  }
  return rested;
}

int read_chip(const std::string& device, Chip& chip) {
  const OpenChip opened(gpiod_chip_open(device.c_str()));
  if (!opened) {
    return errno;
  }
  chip.label = gpiod_chip_label(opened.get());
  const unsigned int lines = gpiod_chip_num_lines(opened.get());
  for (unsigned int i = 0; i < lines; ++i) {  // bound: lines of the chip
    gpiod_line* const line = gpiod_chip_get_line(opened.get(), i);
    chip.lines.push_back(line == nullptr
                             ? ChipLine()
                             : ChipLine{text_of(gpiod_line_name(line)), gpiod_line_is_used(line),
                                        text_of(gpiod_line_consumer(line))});
  }
  return 0;
}

std::string gpio_library() { return text_of("libgpiod ") + gpiod_version_string(); }

}  // namespace tactree::hal::linux_gpio
