#pragma once
// Sessions with a plane that are recorded and replayed.

#include <memory>
#include <utility>
#include <vector>

#include "analytic_shapes.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/recording.hpp"
#include "tactree/simulation/replay.hpp"
#include "tactree/simulation/scene_target.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::test {

inline const Shape& touched_plane() {
  static const Shape shape = plane();
  return shape;
}

struct RecordedSession {
  std::vector<std::byte> bytes;
  simulation::Summary summary;  // of the live session
};

/// A simulated second of rubbing, recorded from the power-up.
inline RecordedSession record_session(std::unique_ptr<simulation::Target> target,
                                      std::vector<simulation::InjectedFault> faults = {}) {
  simulation::SessionWriter writer;
  simulation::Setup setup;
  setup.board.recorder = &writer;
  simulation::Simulation sim(touched_plane().bytes(), setup,
                             simulation::make_script("rub", touched_plane().view(), 1.0),
                             std::move(target));
  (void)sim.arm();
  sim.inject(simulation::Injector(std::move(faults)));
  writer.begin_trace();
  simulation::Recorder recorder;
  for (int i = 0; i < 1000; ++i) {
    recorder.add(sim.step());
  }
  return {writer.finish(), recorder.summary()};
}

/// Replays with the plane as every model.
inline simulation::ReplayResult replay_bytes(const std::vector<std::byte>& bytes) {
  simulation::Recording recording(bytes);
  return simulation::replay(
      recording, std::vector<core::BlobView>(recording.models().size(), touched_plane().view()));
}

}  // namespace tactree::test
