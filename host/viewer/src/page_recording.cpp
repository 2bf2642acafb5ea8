#include "page_recording.hpp"

#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::viewer {
namespace {

namespace fs = std::filesystem;

bool is_free(const fs::path& file) {
  std::error_code ignored;
  return !fs::exists(file, ignored) && !fs::exists(file.string() + support::kIncomplete, ignored);
}

/// FILE, or FILE-2, FILE-3 ... before its extension: no recording replaces another one.
fs::path free_name(const fs::path& file) {
  fs::path name = file;
  for (int number = 2; !is_free(name); ++number) {
    name = file.parent_path() /
           fmt::format("{}-{}{}", file.stem().string(), number, file.extension().string());
  }
  return name;
}

}  // namespace

void PageRecording::begin(const telemetry::RecordingOptions& options) {
  if (recorder_ != nullptr || completion_.valid()) {
    support::refuse("record", "the preceding recording is not complete",
                    "end it, wait until it is complete, and try again");
  }
  file_ = free_name(fs::absolute(target_.file));
  recorder_ = std::make_unique<telemetry::TickRecorder>(file_, options);
  tell("recording to " + file_.string());
}

void PageRecording::add(std::span<const core::wire::Telemetry> messages) {
  if (recorder_ == nullptr) {
    return;
  }
  try {
    (void)recorder_->add(messages);
  } catch (const support::UserError& error) {
    end(error.what());
  }
}

void PageRecording::end(const std::string& why) {
  if (recorder_ == nullptr) {
    return;
  }
  last_ = text();
  completion_ = std::async(std::launch::async, [recorder = std::move(recorder_), file = file_,
                                                why] { return complete(*recorder, file, why); });
}

PageRecording::Outcome PageRecording::complete(telemetry::TickRecorder& recorder,
                                               const fs::path& file, const std::string& why) {
  try {
    recorder.finish();
  } catch (const support::UserError& error) {
    return {error.what(), true};
  }
  const std::string end = why.empty() ? "" : "; the recording ended early. " + why;
  return {fmt::format("{}: {}{}", file.string(), telemetry::summary_of(recorder.counts()), end),
          !why.empty()};
}

std::optional<std::string> PageRecording::update() {
  const bool is_complete = completion_.valid() && completion_.wait_for(std::chrono::seconds(0)) ==
                                                      std::future_status::ready;
  return is_complete ? take_outcome() : std::nullopt;
}

std::optional<std::string> PageRecording::take_outcome() {
  const Outcome outcome = completion_.get();
  last_ = outcome.text;
  tell(outcome.text);
  return outcome.has_problem ? std::optional(outcome.text) : std::nullopt;
}

void PageRecording::finish() {
  end();
  if (completion_.valid()) {
    (void)take_outcome();
  }
}

std::string PageRecording::text() const {
  if (recorder_ == nullptr) {
    return last_;
  }
  return fmt::format("{}: {}", file_.string(), telemetry::summary_of(recorder_->counts()));
}

nlohmann::json PageRecording::to_json() const {
  const char* const state = recorder_ != nullptr  ? "on"
                            : completion_.valid() ? "completing"
                                                  : "off";
  return {{"state", state}, {"text", text()}};
}

void PageRecording::tell(const std::string& text) const {
  if (target_.tell) {
    target_.tell(text);
  }
}

}  // namespace tactree::viewer
