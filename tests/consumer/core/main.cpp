// A controller without a model starts and refuses an empty model.
#include <cstdio>

#include "tactree/core/control/controller.hpp"
#include "tactree/core/model/nearest.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/hal/sim/board.hpp"

int main() {
  const tactree::core::BlobView empty;
  tactree::core::Controller controller;
  const bool configured = controller.configure({}) == tactree::core::ConfigurationStatus::kOk;
  const bool refused = controller.load_model(empty) == tactree::core::ModelStatus::kEmpty;
  const bool nothing = !tactree::core::nearest_within(empty, {}, 0.0F).found();
  std::printf("configured %d, empty model refused %d, nothing found %d\n", configured, refused,
              nothing);
  return configured && refused && nothing ? 0 : 1;
}
