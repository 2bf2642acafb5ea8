#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "image/model_signature.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {

void add_keygen_command(CLI::App& app, int&) {
  auto file = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand(
      "keygen",
      "Generates a key pair for signing models: KEY, to be kept secret, and KEY.pub for boards");
  verb->add_option("KEY", *file, "file for the secret key; it must not exist")->required();
  verb->callback([file] {
    const PublicKey key = generate_key(*file);
    fmt::print("wrote {}, the secret key, and {}.pub, the public key {}\n", *file, *file,
               to_hex(key));
  });
}

}  // namespace tactree::cli
