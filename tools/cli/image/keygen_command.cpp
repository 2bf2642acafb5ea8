#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "image/model_signature.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {

void add_keygen_command(CLI::App& app, int&) {
  auto file = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("keygen",
                                      "Generates a key pair for signing models: KEY, to be kept "
                                      "secret, and its public key, KEY.pub to check signatures "
                                      "and KEY.hpp for the firmware of a board");
  verb->add_option("KEY", *file, "file for the secret key; it must not exist")->required();
  verb->callback([file] {
    const PublicKey key = generate_key(*file);
    fmt::print("wrote {0}, the secret key, and {0}.pub and {0}.hpp, the public key {1}\n", *file,
               to_hex(key));
  });
}

}  // namespace tactree::cli
