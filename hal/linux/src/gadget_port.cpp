#include "tactree/hal/linux/gadget_port.hpp"

namespace tactree::hal {

GadgetPort::GadgetPort(const core::usb::Identity& identity, const std::string& udc)
    : controller_(identity, udc, false), device_(controller_, identity, true, nothing_, nothing_) {
  controller_.plug_in();
}

void GadgetPort::attend(const core::Status& status, std::uint32_t now_us) {
  device_.poll(now_us);
  device_.send_changes(status);
}

}  // namespace tactree::hal
