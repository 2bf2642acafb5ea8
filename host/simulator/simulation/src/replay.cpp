#include "tactree/simulation/replay.hpp"

#include <fmt/format.h>

#include <memory>

namespace tactree::simulation {
namespace {

class Replay {
 public:
  explicit Replay(const std::vector<core::BlobView>& models) : models_(models) {}

  void operator()(const core::Configuration& configuration) {
    rate_hz_ = static_cast<double>(configuration.rate_hz);
    check("the configuration", controller_->configure(configuration));
  }
  void operator()(const core::Adjustment& adjustment) {
    check("an adjustment", controller_->adjust(adjustment));
  }
  void operator()(const LoadModel& load) {
    check("a model", controller_->load_model(models_[load.model]));
  }
  void operator()(const AddBody& body) {
    std::uint32_t number = 0;
    check("a body", controller_->add_body(models_[body.model], body.pose, number));
  }
  void operator()(const RemoveBody& body) {
    check("the removal of a body", controller_->remove_body(body.number));
  }
  void operator()(const UnloadModel& /*unload*/) {
    check("the removal of the model", controller_->unload_model());
  }
  void operator()(const BeginTrace& /*begin*/) { recorder_ = {}; }

  void operator()(const RecordedTick& recorded) {
    core::Input input{recorded.readings, recorded.bodies, recorded.added_force};
    const core::Output& output = controller_->step(input);
    const core::MotorCommand& motors = output.motors;
    const std::uint32_t outcome = checksum_of(
        {{motors.effort(0), motors.effort(1), motors.effort(2)}, output.enable, output.status});
    if (outcome != recorded.outcome) {
      differ(fmt::format("outcome {:08x}, recorded {:08x}", outcome, recorded.outcome));
      return;
    }
    recorder_.add({static_cast<double>(result_.ticks) / rate_hz_, {}, output.status});
    ++result_.ticks;
  }

  [[nodiscard]] bool differs() const { return result_.difference.has_value(); }

  [[nodiscard]] ReplayResult finish(std::uint32_t trace_crc32) {
    result_.summary = recorder_.summary();
    if (!differs() && result_.summary.trace_crc32 != trace_crc32) {
      differ(fmt::format("trace checksum {:08x}, recorded {:08x}", result_.summary.trace_crc32,
                         trace_crc32));
    }
    return result_;
  }

 private:
  template <class Status>
  void check(const char* event, Status status) {
    if (status != Status::kOk) {
      differ(fmt::format("{} was refused: {}", event, core::describe(status)));
    }
  }
  void differ(std::string cause) { result_.difference = {result_.ticks, std::move(cause)}; }

  const std::vector<core::BlobView>& models_;
  std::unique_ptr<core::Controller> controller_ = std::make_unique<core::Controller>();
  Recorder recorder_;
  ReplayResult result_;
  double rate_hz_ = 1.0;
};

}  // namespace

ReplayResult replay(Recording& recording, const std::vector<core::BlobView>& models) {
  Replay replay(models);
  RecordedEvent event;
  recording.rewind();
  while (!replay.differs() && recording.next(event)) {
    std::visit(replay, event);
  }
  return replay.finish(recording.trace_crc32());
}

}  // namespace tactree::simulation
