// A client of a simulated board in lock-step: arms it, pushes, stops it.

#include "tactree/share/shared_board.hpp"

#include <gtest/gtest.h>

#include <future>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "running_board.hpp"
#include "tactree/share/clients.hpp"

namespace tactree::test {
namespace {

using nlohmann::json;

/// Answers each state.
class PushingProgram {
 public:
  std::string answer(const json& state) {
    const json& own = state["tactree"];
    const json force_N = own["force_N"];
    const std::string mode = own["state"];
    if (step_ == 0) {
      step_ = 1;
      return R"({"tactree":{"arm":true}})";
    }
    if (step_ == 1 && force_N["x"].get<double>() > 0.2) {
      step_ = 2;
      return R"({"tactree":{"stop":true}})";
    }
    if (step_ == 2 && mode == "idle" && force_N["x"] == 0.0) {
      step_ = 3;
    }
    if (step_ != 1 || mode != "active") {
      return "{}";
    }
    const json values = {{"x", 0.5}, {"y", 0.0}, {"z", 0.0}};
    const json command = {{"set_cursor_force", {{"values", values}}}};
    const json device = {{"device_id", state["inverse3"][0]["device_id"]}, {"commands", command}};
    return json::object({{"inverse3", json::array({device})}}).dump();
  }
  [[nodiscard]] bool has_ended() const { return step_ == 3; }

 private:
  int step_ = 0;
};

TEST(SharedBoard, AddsForceOfClientUntilItStops) {
  const RunningBoard running;
  share::BoardSettings settings;
  settings.port = running.port();
  settings.tell = [](const std::string&) {};
  share::SharedBoard board(settings);
  share::Clients clients(board, share::Grip::kNone);
  const unsigned client = clients.join("here:1");
  PushingProgram program;
  std::promise<bool> result;
  unsigned states = 0;
  bool done = false;
  // Client and board in one thread, so that each tick is answered before the next one.
  board.start([&](const std::vector<share::Snapshot>& snapshots) {
    for (const share::Snapshot& snapshot : snapshots) {
      clients.offer(snapshot);
      const share::Message message = clients.next(client);
      if (message != nullptr && !done) {
        clients.receive(client, program.answer(json::parse(*message)));
      }
      ++states;
      if (!done && (program.has_ended() || states == 20'000U)) {
        done = true;
        result.set_value(program.has_ended());
      }
    }
  });
  EXPECT_TRUE(result.get_future().get());
  board.end();
}

}  // namespace
}  // namespace tactree::test
