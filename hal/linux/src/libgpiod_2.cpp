// GpioLines with libgpiod 2.x: one request for all lines; the kernel numbers their edges.
//
// Loop and memory annotations: docs/BOUND.md.

#include <fcntl.h>
#include <gpiod.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "gpio_chip.hpp"

namespace tactree::hal::linux_gpio {
namespace {

template <auto kRelease>
struct Release {
  template <class T>
  void operator()(T* object) const {
    kRelease(object);
  }
};
template <class T, auto kRelease>
using Owned = std::unique_ptr<T, Release<kRelease>>;

using OpenChip = Owned<gpiod_chip, gpiod_chip_close>;
using LineRequest = Owned<gpiod_line_request, gpiod_line_request_release>;
using EdgeBuffer = Owned<gpiod_edge_event_buffer, gpiod_edge_event_buffer_free>;
using Settings = Owned<gpiod_line_settings, gpiod_line_settings_free>;
using Lines = Owned<gpiod_line_config, gpiod_line_config_free>;
using Options = Owned<gpiod_request_config, gpiod_request_config_free>;
using ChipInfo = Owned<gpiod_chip_info, gpiod_chip_info_free>;
using LineInfo = Owned<gpiod_line_info, gpiod_line_info_free>;

ChipLine line_of(gpiod_line_info* info) {
  return {text_of(gpiod_line_info_get_name(info)), gpiod_line_info_is_used(info),
          text_of(gpiod_line_info_get_consumer(info))};
}

gpiod_line_bias bias_of(Bias bias) {
  switch (bias) {
    case Bias::kPullUp:
      return GPIOD_LINE_BIAS_PULL_UP;
    case Bias::kPullDown:
      return GPIOD_LINE_BIAS_PULL_DOWN;
    case Bias::kAsIs:
      break;
  }
  return GPIOD_LINE_BIAS_AS_IS;
}

}  // namespace

struct GpioLines::Request {
  struct Numbered {
    Edge edge;
    std::uint32_t number = 0;
  };

  Request(const WantedLines& wanted, gpiod_line_settings* settings, std::uint32_t edge_buffer);
  [[nodiscard]] int read() noexcept;
  void count(std::uint32_t number) noexcept;

  std::vector<unsigned int> offsets;
  LineRequest lines;
  EdgeBuffer buffer;
  std::array<Numbered, kEdgesAtOnce> found{};
  std::uint32_t next_number = 1;
  std::uint32_t lost = 0;
};

GpioLines::Request::Request(const WantedLines& wanted, gpiod_line_settings* settings,
                            std::uint32_t edge_buffer)
    : buffer(gpiod_edge_event_buffer_new(kEdgesAtOnce)) {
  for (const LinePlace& place : wanted.places) {  // bound: kMaxLines
    offsets.push_back(place.offset);
  }
  const Lines config(gpiod_line_config_new());
  const Options options(gpiod_request_config_new());
  const OpenChip chip(gpiod_chip_open(wanted.chip().c_str()));
  if (!chip || !config || !options || !buffer ||
      gpiod_line_config_add_line_settings(config.get(), offsets.data(), offsets.size(), settings) !=
          0) {
    refuse(wanted, errno);
  }
  gpiod_request_config_set_consumer(options.get(), wanted.consumer.c_str());
  gpiod_request_config_set_event_buffer_size(options.get(), edge_buffer);
  lines.reset(gpiod_chip_request_lines(chip.get(), options.get(), config.get()));
  if (!lines) {
    refuse(wanted, errno);
  }
  const int file = gpiod_line_request_get_fd(lines.get());
  (void)fcntl(file, F_SETFL, fcntl(file, F_GETFL) | O_NONBLOCK);
}

/// Fills `found` and returns the number of edges, or -1 if the chip was removed.
int GpioLines::Request::read() noexcept {
  const int count = gpiod_line_request_read_edge_events(lines.get(), buffer.get(), found.size());
  if (count < 0) {
    return errno == EAGAIN || errno == EINTR ? 0 : -1;
  }
  for (int i = 0; i < count; ++i) {  // bound: kEdgesAtOnce
    gpiod_edge_event* const event =
        gpiod_edge_event_buffer_get_event(buffer.get(), static_cast<unsigned long>(i));
    const auto at =
        std::find(offsets.begin(), offsets.end(), gpiod_edge_event_get_line_offset(event));
    found[static_cast<std::size_t>(i)] = {
        {gpiod_edge_event_get_timestamp_ns(event), static_cast<std::uint32_t>(at - offsets.begin()),
         gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE},
        static_cast<std::uint32_t>(gpiod_edge_event_get_global_seqno(event))};
  }
  // The interrupt numbers an edge; a separate thread for each line puts it into the queue later.
  std::sort(found.begin(), found.begin() + count, [](const Numbered& a, const Numbered& b) {
    return static_cast<std::int32_t>(a.number - b.number) < 0;
  });
  return count;
}

// A number occurs twice if a line had two interrupts before its thread ran: one edge was lost.
void GpioLines::Request::count(std::uint32_t number) noexcept {
  const auto gap = static_cast<std::int32_t>(number - next_number);
  lost += gap >= 0 ? static_cast<std::uint32_t>(gap) : 1U;
  next_number = gap >= 0 ? number + 1U : next_number;
}

GpioLines::GpioLines(std::unique_ptr<Request> request) : request_(std::move(request)) {}
GpioLines::~GpioLines() = default;
GpioLines::GpioLines(GpioLines&&) noexcept = default;

GpioLines GpioLines::inputs(const std::vector<std::string>& names, const std::string& consumer,
                            const InputSettings& settings) {
  const Settings line(gpiod_line_settings_new());
  gpiod_line_settings_set_direction(line.get(), GPIOD_LINE_DIRECTION_INPUT);
  gpiod_line_settings_set_active_low(line.get(), settings.active_low);
  gpiod_line_settings_set_bias(line.get(), bias_of(settings.bias));
  gpiod_line_settings_set_event_clock(line.get(), GPIOD_LINE_CLOCK_MONOTONIC);
  if (settings.edges) {
    gpiod_line_settings_set_edge_detection(line.get(), GPIOD_LINE_EDGE_BOTH);
  }
  GpioLines lines(std::make_unique<Request>(find_lines(names, consumer), line.get(),
                                            settings.edges ? settings.edge_buffer : 0U));
  if (settings.edges) {
    lines.await_rest(names.front());
  }
  return lines;
}

GpioLines GpioLines::outputs(const std::vector<std::string>& names, const std::string& consumer,
                             bool active_low) {
  const Settings line(gpiod_line_settings_new());
  gpiod_line_settings_set_direction(line.get(), GPIOD_LINE_DIRECTION_OUTPUT);
  gpiod_line_settings_set_active_low(line.get(), active_low);
  gpiod_line_settings_set_output_value(line.get(), GPIOD_LINE_VALUE_INACTIVE);
  return GpioLines(std::make_unique<Request>(find_lines(names, consumer), line.get(), 0U));
}

bool GpioLines::levels(std::uint64_t& bits) const noexcept {
  std::array<gpiod_line_value, kMaxLines> values;
  if (gpiod_line_request_get_values(request_->lines.get(), values.data()) != 0) {
    return false;
  }
  bits = 0;
  for (std::size_t i = 0; i < request_->offsets.size(); ++i) {  // bound: kMaxLines
    bits |= static_cast<std::uint64_t>(values[i] == GPIOD_LINE_VALUE_ACTIVE) << i;
  }
  return true;
}

bool GpioLines::set(std::uint64_t bits) noexcept {
  std::array<gpiod_line_value, kMaxLines> values;
  for (std::size_t i = 0; i < request_->offsets.size(); ++i) {  // bound: kMaxLines
    values[i] = ((bits >> i) & 1U) != 0U ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  }
  return gpiod_line_request_set_values(request_->lines.get(), values.data()) == 0;
}

int GpioLines::read_edges(std::array<Edge, kEdgesAtOnce>& edges) noexcept {
  const int found = request_->read();
  for (int i = 0; i < found; ++i) {  // bound: kEdgesAtOnce
    const auto at = static_cast<std::size_t>(i);
    request_->count(request_->found[at].number);
    edges[at] = request_->found[at].edge;
  }
  return found;
}

// No edges are held back, because all lines share one queue.
std::uint64_t GpioLines::held() const { return 0; }

std::uint32_t GpioLines::lost() const { return request_->lost; }

void GpioLines::begin_edges() noexcept {
  std::array<Edge, kEdgesAtOnce> edges;
  while (read_edges(edges) ==
         static_cast<int>(kEdgesAtOnce)) {  // bound: edge_buffer / kEdgesAtOnce
  }
  request_->lost = 0;
}

// read_edges() counts the edges of a line that is not at rest, so they are not reported as lost
// later.
bool GpioLines::is_at_rest() noexcept {
  std::array<Edge, kEdgesAtOnce> edges;
  return read_edges(edges) <= 0;
}

int read_chip(const std::string& device, Chip& chip) {
  const OpenChip opened(gpiod_chip_open(device.c_str()));
  const ChipInfo info(opened ? gpiod_chip_get_info(opened.get()) : nullptr);
  if (!info) {
    return errno;
  }
  chip.label = text_of(gpiod_chip_info_get_label(info.get()));
  const std::size_t lines = gpiod_chip_info_get_num_lines(info.get());
  for (unsigned int i = 0; i < lines; ++i) {  // bound: lines of the chip
    const LineInfo line(gpiod_chip_get_line_info(opened.get(), i));
    chip.lines.push_back(line ? line_of(line.get()) : ChipLine());
  }
  return 0;
}

std::string gpio_library() { return text_of("libgpiod ") + gpiod_api_version(); }

}  // namespace tactree::hal::linux_gpio
