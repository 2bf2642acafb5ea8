#pragma once
// Owners of libusb handles.

#include <libusb.h>

#include <memory>
#include <optional>
#include <string>

#include "tactree/client/usb_devices.hpp"
#include "tactree/core/link/usb/descriptors.hpp"

namespace tactree::client {

struct FreeContext {
  void operator()(libusb_context* context) const { libusb_exit(context); }
};
struct FreeHandle {
  void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};
using Context = std::unique_ptr<libusb_context, FreeContext>;
using Handle = std::unique_ptr<libusb_device_handle, FreeHandle>;

[[nodiscard]] Context make_context();

/// Throws LinkError with the message "usb 1209:0001 3-1.2: cause (hint: ...)".
[[noreturn]] void fail(const std::string& label, int error);

/// Calls `visit(device, descriptor, path)` for each device with a link interface.
template <class Visit>
void for_each_board(libusb_context* context, Visit visit);

[[nodiscard]] std::string path_of(libusb_device* device);
[[nodiscard]] bool has_link(libusb_device* device);

/// Addresses of the link's endpoints. They are read from the descriptors, because device
/// controllers may number them differently.
struct LinkEndpoints {
  std::uint8_t in = 0;
  std::uint8_t out = 0;
  std::uint8_t news = 0;
};
/// Empty if the device has no link.
[[nodiscard]] std::optional<LinkEndpoints> find_link(libusb_device* device);

template <class Visit>
void for_each_board(libusb_context* context, Visit visit) {
  libusb_device** list = nullptr;
  const auto count = libusb_get_device_list(context, &list);
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(list[i], &descriptor) == LIBUSB_SUCCESS && has_link(list[i])) {
      visit(list[i], descriptor, path_of(list[i]));
    }
  }
  if (count >= 0) {
    libusb_free_device_list(list, 1);
  }
}

}  // namespace tactree::client
