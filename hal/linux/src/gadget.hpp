#pragma once
// A USB gadget with one FunctionFS function, set up through configfs.

#include <string>

#include "tactree/core/usb/descriptors.hpp"

namespace tactree::hal::linux_usb {

class Gadget {
 public:
  /// Makes gadget and mount; nothing is on the bus yet. Takes down what killed programs left.
  /// Throws std::runtime_error.
  explicit Gadget(const core::usb::Identity& identity);
  ~Gadget();
  Gadget(const Gadget&) = delete;
  Gadget& operator=(const Gadget&) = delete;

  /// After the descriptors were written: pulls the bus's line up.
  void bind(const std::string& udc);
  /// Where FunctionFS is mounted.
  [[nodiscard]] const std::string& mount() const { return mount_; }

 private:
  static void take_down(const std::string& name);
  static void take_down_left_over();

  std::string name_;
  std::string folder_;
  std::string mount_;
};

}  // namespace tactree::hal::linux_usb
