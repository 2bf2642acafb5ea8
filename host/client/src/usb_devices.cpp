#include "tactree/client/usb_devices.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "libusb.hpp"
#include "tactree/client/link_error.hpp"

namespace tactree::client {
namespace {

std::string read_string(libusb_device_handle* handle, std::uint8_t index) {
  std::array<unsigned char, 256> text{};
  const int length = index == 0 ? 0
                                : libusb_get_string_descriptor_ascii(handle, index, text.data(),
                                                                     static_cast<int>(text.size()));
  return length > 0 ? std::string(text.begin(), text.begin() + length) : std::string();
}

void describe(libusb_device* device, const libusb_device_descriptor& descriptor,
              UsbDeviceInfo& info) {
  libusb_device_handle* opened = nullptr;
  const int error = libusb_open(device, &opened);
  if (error != LIBUSB_SUCCESS) {
    try {
      fail(info.label(), error);
    } catch (const LinkError& reason) {
      info.problem = reason.what();
    }
    return;
  }
  const Handle handle(opened);
  info.maker = read_string(opened, descriptor.iManufacturer);
  info.name = read_string(opened, descriptor.iProduct);
  info.serial = read_string(opened, descriptor.iSerialNumber);
}

std::vector<UsbDeviceInfo> list_devices(libusb_context* context) {
  std::vector<UsbDeviceInfo> devices;
  for_each_board(context, [&](libusb_device* device, const libusb_device_descriptor& descriptor,
                              const std::string& path) {
    UsbDeviceInfo info;
    info.vendor = descriptor.idVendor;
    info.product = descriptor.idProduct;
    info.path = path;
    describe(device, descriptor, info);
    devices.push_back(info);
  });
  std::sort(devices.begin(), devices.end(),
            [](const UsbDeviceInfo& a, const UsbDeviceInfo& b) { return a.path < b.path; });
  return devices;
}

std::string remedy(int error) {
  if (error == LIBUSB_ERROR_ACCESS) {
    return " (hint: run `tactree devices --install-udev` as root, then plug the board in again; or "
           "write this to /etc/udev/rules.d/70-tactree.rules:\n" +
           udev_rule() + ")";
  }
  if (error == LIBUSB_ERROR_BUSY) {
    return " (hint: end the other program that uses it)";
  }
  return " (hint: plug it in again)";
}

}  // namespace

Context make_context() {
  libusb_context* context = nullptr;
  const int error = libusb_init(&context);
  if (error != LIBUSB_SUCCESS) {
    throw LinkError(std::string("usb: ") + libusb_strerror(error) +
                    " (hint: check that /dev/bus/usb exists)");
  }
  return Context(context);
}

void fail(const std::string& label, int error) {
  throw LinkError(label + ": " + libusb_strerror(error) + remedy(error));
}

std::string path_of(libusb_device* device) {
  std::array<std::uint8_t, 8> ports{};
  const int count = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  std::string path = std::to_string(libusb_get_bus_number(device));
  for (int i = 0; i < count; ++i) {
    path += i == 0 ? '-' : '.';
    path += std::to_string(ports[static_cast<std::size_t>(i)]);
  }
  return path;
}

namespace {

bool is_link(const libusb_interface_descriptor& interface) {
  return interface.bInterfaceClass == core::usb::kLinkClass &&
         interface.bInterfaceSubClass == core::usb::kLinkSubclass &&
         interface.bInterfaceProtocol == core::usb::kLinkProtocol &&
         interface.bInterfaceNumber == core::usb::kLinkInterface;
}

LinkEndpoints endpoints_of(const libusb_interface_descriptor& interface) {
  LinkEndpoints found;
  for (std::uint8_t i = 0; i < interface.bNumEndpoints; ++i) {
    const libusb_endpoint_descriptor& endpoint = interface.endpoint[i];
    const bool in = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0;
    const int type = endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK;
    if (type == LIBUSB_TRANSFER_TYPE_BULK) {
      (in ? found.in : found.out) = endpoint.bEndpointAddress;
    } else if (type == LIBUSB_TRANSFER_TYPE_INTERRUPT && in) {
      found.news = endpoint.bEndpointAddress;
    }
  }
  return found;
}

}  // namespace

std::optional<LinkEndpoints> find_link(libusb_device* device) {
  libusb_config_descriptor* configuration = nullptr;
  if (libusb_get_active_config_descriptor(device, &configuration) != LIBUSB_SUCCESS) {
    return std::nullopt;  // not configured yet, or gone
  }
  std::optional<LinkEndpoints> found;
  for (std::uint8_t i = 0; i < configuration->bNumInterfaces; ++i) {
    const libusb_interface& interface = configuration->interface[i];
    if (interface.num_altsetting > 0 && is_link(interface.altsetting[0])) {
      found = endpoints_of(interface.altsetting[0]);
    }
  }
  libusb_free_config_descriptor(configuration);
  const bool whole = found && found->in != 0 && found->out != 0 && found->news != 0;
  return whole ? found : std::nullopt;
}

bool has_link(libusb_device* device) { return find_link(device).has_value(); }

std::string UsbDeviceInfo::label() const {
  std::array<char, 16> numbers{};
  std::snprintf(numbers.data(), numbers.size(), "%04x:%04x", vendor, product);
  return std::string("usb ") + numbers.data() + " " + path;
}

std::vector<std::string> usb_paths() {
  std::vector<std::string> paths;
  try {
    for_each_board(make_context().get(), [&](libusb_device*, const libusb_device_descriptor&,
                                             const std::string& path) { paths.push_back(path); });
  } catch (const LinkError&) {  // USB cannot be used
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::vector<UsbDeviceInfo> list_usb_devices() { return list_devices(make_context().get()); }

/// One context for the whole watch, which receives the udev events.
struct UsbWatch::Hotplug {
  Context context = make_context();
  bool something_happened = true;

  Hotplug() {
    if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) != 0) {
      // Without udev this may fail, or have no effect; polling finds the changes.
      (void)libusb_hotplug_register_callback(
          context.get(), LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, 0,
          LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, &notice,
          this, nullptr);
    }
  }
  static int LIBUSB_CALL notice(libusb_context*, libusb_device*, libusb_hotplug_event, void* self) {
    static_cast<Hotplug*>(self)->something_happened = true;
    return 0;
  }
};

UsbWatch::UsbWatch(std::chrono::milliseconds look_every)
    : hotplug_(std::make_unique<Hotplug>()), look_every_(look_every) {}

UsbWatch::~UsbWatch() = default;

std::vector<UsbWatch::Change> UsbWatch::poll(Clock::time_point now) {
  timeval no_time{};
  libusb_handle_events_timeout_completed(hotplug_->context.get(), &no_time, nullptr);
  if (!hotplug_->something_happened && now < next_look_) {
    return {};
  }
  hotplug_->something_happened = false;
  next_look_ = now + look_every_;
  // A context without udev events does not find new devices, so each list uses a new one.
  std::vector<UsbDeviceInfo> devices = list_usb_devices();
  std::vector<Change> changes;
  const auto add = [&](const auto& from, const auto& other, bool arrived) {
    for (const UsbDeviceInfo& device : from) {
      if (std::find(other.begin(), other.end(), device) == other.end()) {
        changes.push_back({arrived, device});
      }
    }
  };
  add(known_, devices, false);
  add(devices, known_, true);
  known_ = std::move(devices);
  return changes;
}

}  // namespace tactree::client
