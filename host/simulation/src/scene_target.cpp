#include "tactree/simulation/scene_target.hpp"

#include <stdexcept>
#include <utility>

namespace tactree::simulation {

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
    result = add(bodies_[i], number);
    numbers_.push_back(number);
  }
  if (result.ok()) {
    move_bodies(tick_ * period_s_);
  }
  return result;
}

hal::StartResult SceneTarget::add(const SceneBody& body, std::uint32_t& number) {
  hal::StartResult result;
  core::BlobView view;
  result.blob = core::open_blob(body.blob, view);
  if (result.blob == core::BlobStatus::kOk) {
    result.model = controller_.add_body(view, body.path.at(0.0).pose, number);
  }
  return result;
}

core::Status SceneTarget::tick(hal::sim::SimBoard& board) {
  move_bodies(tick_ * period_s_);
  tick_ += 1.0;
  return hal::Loop(board, controller_).tick().status;
}

// Where a body has left the space that a controller accepts, it stays at the border.
void SceneTarget::move_bodies(double t_s) {
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    const BodyPath::Moment moment = bodies_[i].path.at(t_s);
    (void)controller_.move_body(numbers_[i], moment.pose, moment.motion);
    (void)controller_.enable_body(numbers_[i],
                                  t_s >= bodies_[i].from_s && t_s < bodies_[i].until_s);
  }
}

}  // namespace tactree::simulation
