#pragma once
// A USB gadget with one FunctionFS function, set up through configfs.

#include <string>

#include "tactree/core/link/usb/descriptors.hpp"

namespace tactree::hal::linux_usb {

class Gadget {
 public:
  /// Creates the gadget and mounts FunctionFS; does not connect to the bus yet. Removes gadgets of
  /// killed programs. Throws std::runtime_error.
  explicit Gadget(const core::usb::Identity& identity);
  ~Gadget();
  Gadget(const Gadget&) = delete;
  Gadget& operator=(const Gadget&) = delete;

  /// Connects to the bus. Call after the descriptors were written to FunctionFS.
  void bind(const std::string& udc);
  /// Mount point of FunctionFS.
  [[nodiscard]] const std::string& mount() const { return mount_; }

 private:
  static void take_down(const std::string& name);
  static void take_down_left_over();

  std::string name_;
  std::string folder_;
  std::string mount_;
};

}  // namespace tactree::hal::linux_usb
