#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "image/model_signature.hpp"
#include "option_checks.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

struct SignOptions {
  std::string blob;
  std::string key;
  std::string board;
  std::uint32_t counter = 0;
};

void sign(const SignOptions& options) {
  const support::BlobFile blob(options.blob);
  const ModelSignature signature =
      sign_model(read_secret_key(options.key), blob.bytes(), options.board, options.counter);
  write_signature(options.blob, signature, blob.bytes().size());
  fmt::print("{}: signed for {} with counter {}, by {}\n", signature_path(options.blob).string(),
             options.board.empty() ? "any board" : options.board, options.counter,
             to_hex(signature.key));
}

}  // namespace

void add_sign_command(CLI::App& app, int&) {
  auto options = std::make_shared<SignOptions>();
  CLI::App* verb = app.add_subcommand(
      "sign", "Signs a blob for boards that require a signature; writes BLOB.sig");
  verb->add_option("BLOB", options->blob, "the blob to sign")->required();
  verb->add_option("--key", options->key, "secret key, from tactree keygen")
      ->required()
      ->check(existing_file());
  verb->add_option("--counter", options->counter,
                   "a board refuses a model with a smaller counter than it has accepted before")
      ->required();
  verb->add_option("--board", options->board,
                   "name of the only board that accepts it (default: any board)");
  verb->callback([options] { sign(*options); });
}

}  // namespace tactree::cli
