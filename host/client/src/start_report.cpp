#include "tactree/client/start_report.hpp"

#include <cstdio>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/scene.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::client {
namespace {

using core::wire::StartPart;

struct PartName {
  StartPart part;
  const char* name;
};

constexpr PartName kParts[] = {
    {StartPart::kEncoders, "encoders"},
    {StartPart::kMotors, "motors"},
    {StartPart::kEnableLine, "enable line"},
    {StartPart::kSafetyInputs, "emergency stop and dead-man control"},
    {StartPart::kWatchdog, "watchdog"},
    {StartPart::kReceiver, "receiver of the link"},
    {StartPart::kUsb, "USB controller"},
    {StartPart::kCrystal, "crystal"},
    {StartPart::kCrystalFrequency, "crystal (of a wrong frequency)"},
    {StartPart::kWaitStates, "wait states of the flash"},
    {StartPart::kPll, "clock multiplier"},
    {StartPart::kClockSwitch, "switch to the full clock"},
};

std::string missing_parts(std::uint32_t missing) {
  std::string names;
  for (const PartName& part : kParts) {
    const auto bit = static_cast<std::uint32_t>(part.part);
    if ((missing & bit) != 0U) {
      names += std::string(names.empty() ? "" : ", ") + part.name;
      missing &= ~bit;
    }
  }
  if (missing != 0U) {
    names += std::string(names.empty() ? "" : ", ") + "a component that this program does not know";
  }
  return names;
}

// Describes the first failure; the start does not attempt the steps after it.
std::string no_model(const core::wire::ReadStartReply& start) {
  if (start.image != 0U) {
    return start.image == 1U ? "its program is damaged (program the image again)"
                             : "RAM self-test failed (replace the controller)";
  }
  if (start.configuration != 0U) {
    return std::string("its configuration: ") +
           core::describe(static_cast<core::ConfigurationStatus>(start.configuration));
  }
  if (start.blob != 0U) {
    return std::string("no model: ") + core::describe(static_cast<core::BlobStatus>(start.blob)) +
           " (tactree flash)";
  }
  if (start.model != 0U) {
    return std::string("its model cannot be used: ") +
           core::describe(static_cast<core::ModelStatus>(start.model)) + " (tactree flash)";
  }
  return "";
}

std::string last_fault(const core::wire::ReadStartReply& start) {
  char text[160];
  std::snprintf(text, sizeof text,
                "its last run ended with exception %u at 0x%08x, called from 0x%08x, status "
                "0x%08x, address 0x%08x",
                start.fault_cause, start.fault_pc, start.fault_lr, start.fault_status,
                start.fault_address);
  return text;
}

}  // namespace

std::vector<std::string> complaints(const core::wire::ReadStartReply& start) {
  std::vector<std::string> all;
  if (std::string text = no_model(start); !text.empty()) {
    all.push_back("at its start: " + text);
  }
  if (start.missing != 0U) {
    all.push_back("motors disabled; did not start: " + missing_parts(start.missing) +
                  " (its README states where to measure)");
  }
  if (start.by_watchdog != 0U) {
    all.emplace_back("the watchdog reset the board: a tick hung or took too long");
  }
  if (start.fault_cause != 0U) {
    all.push_back(last_fault(start));
  }
  return all;
}

}  // namespace tactree::client
