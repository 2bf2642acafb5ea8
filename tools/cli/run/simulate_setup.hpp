#pragma once
// Builds a simulation from the options of `tactree simulate`, and reports a refused start.

#include <string>
#include <vector>

#include "run/simulate_options.hpp"
#include "tactree/setup/scene_file.hpp"
#include "tactree/simulation/injection.hpp"
#include "tactree/simulation/user.hpp"

namespace tactree::cli {

/// Throws UserError with the text "what (hint)", where `what` states what was refused.
[[noreturn]] void refuse(const std::string& what, const std::string& remedy);

/// Device, controller and mechanics. Throws UserError.
[[nodiscard]] simulation::Setup make_setup(const SimulateOptions& options,
                                           const setup::SceneFile& scene);

/// Path of the hand. A script touches the first body at its first pose. Throws UserError.
[[nodiscard]] simulation::HandPath hand_path(const SimulateOptions& options,
                                             const setup::SceneFile& scene);

[[nodiscard]] std::vector<simulation::InjectedFault> injections(const SimulateOptions& options);

/// The presses of the button (--panel).
[[nodiscard]] std::vector<simulation::Press> presses(const SimulateOptions& options);

/// Throws UserError if an option needs an application, which a board with --panel does not have.
void check_panel(const SimulateOptions& options);

/// Throws UserError unless `start` is ok(). `file` and `view` are those of the refused body.
void check_start(const std::string& file, const core::BlobView& view,
                 const simulation::Setup& setup, const hal::StartResult& start,
                 const SimulateOptions& options);

}  // namespace tactree::cli
