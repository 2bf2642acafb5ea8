#include "tactree/simulation/scene_target.hpp"

#include <stdexcept>
#include <utility>

namespace tactree::simulation {

hal::BodyUpdate update_at(const SceneBody& body, std::uint32_t number, double t_s) {
  const BodyPath::Moment moment = body.path.at(t_s);
  return {number, t_s >= body.from_s && t_s < body.until_s, moment.pose, moment.motion};
}

SceneTarget::SceneTarget(std::vector<SceneBody> bodies, std::uint64_t ticks_before)
    : bodies_(std::move(bodies)), tick_(-static_cast<double>(ticks_before)) {
  if (bodies_.empty()) {
    throw std::invalid_argument("a scene needs a body");
  }
}

hal::StartResult SceneTarget::start(hal::sim::SimBoard& board,
                                    const core::Configuration& configuration) {
  period_s_ = 1.0 / static_cast<double>(configuration.rate_hz);
  hal::StartResult result = hal::Loop(board, controller_).start(configuration);
  numbers_ = {0};
  for (std::size_t i = 1; i < bodies_.size() && result.ok(); ++i) {
    refused_body_ = i;
    std::uint32_t number = 0;
    result = add(board, bodies_[i], number);
    numbers_.push_back(number);
  }
  return result;
}

hal::StartResult SceneTarget::add(hal::sim::SimBoard& board, const SceneBody& body,
                                  std::uint32_t& number) {
  hal::StartResult result;
  core::BlobView view;
  result.blob = core::open_blob(body.blob, view);
  if (result.blob == core::BlobStatus::kOk) {
    const core::Pose pose = body.path.at(0.0).pose;
    core::Uninterrupted before_ticks(board);
    result.model = core::BetweenTicks(controller_, before_ticks).add_body(view, pose, number);
  }
  return result;
}

core::Status SceneTarget::tick(hal::sim::SimBoard& board) {
  move_bodies(board, tick_ * period_s_);
  tick_ += 1.0;
  return hal::Loop(board, controller_).tick().status;
}

core::ConfigurationStatus SceneTarget::adjust(hal::sim::SimBoard& board,
                                              const core::Adjustment& adjustment) {
  core::Uninterrupted between_ticks(board);
  return core::BetweenTicks(controller_, between_ticks).adjust(adjustment);
}

void SceneTarget::move_bodies(hal::sim::SimBoard& board, double t_s) {
  updates_.clear();
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    updates_.push_back(update_at(bodies_[i], numbers_[i], t_s));
  }
  board.link().move_bodies(updates_);
}

LinkedBodyTarget::LinkedBodyTarget(std::unique_ptr<Target> target, SceneBody body,
                                   std::uint64_t ticks_before)
    : target_(std::move(target)),
      body_(std::move(body)),
      tick_(-static_cast<double>(ticks_before)) {}

hal::StartResult LinkedBodyTarget::start(hal::sim::SimBoard& board,
                                         const core::Configuration& configuration) {
  period_s_ = 1.0 / static_cast<double>(configuration.rate_hz);
  return target_->start(board, configuration);
}

core::Status LinkedBodyTarget::tick(hal::sim::SimBoard& board) {
  board.link().attach(update_at(body_, 0, tick_ * period_s_));
  tick_ += 1.0;
  return target_->tick(board);
}

}  // namespace tactree::simulation
