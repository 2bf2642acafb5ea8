#include "run/wall_options.hpp"

#include "option_checks.hpp"

namespace tactree::cli {

void add_wall_options(CLI::App& verb, core::Configuration& c) {
  verb.add_option("--rate", c.rate_hz, "ticks per second, Hz")
      ->check(within(100.0, 20000.0))
      ->capture_default_str();
  verb.add_option("--stiffness", c.contact.stiffness_N_m, "of the surface, N/m")
      ->check(within(0.0, 1e5))
      ->capture_default_str();
  verb.add_option("--damping", c.contact.damping_Ns_m, "of the surface, Ns/m")
      ->check(within(0.0, 1e3))
      ->capture_default_str();
}

}  // namespace tactree::cli
