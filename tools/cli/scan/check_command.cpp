#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "image/model_signature.hpp"
#include "option_checks.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

struct CheckOptions {
  std::string blob;
  std::string json;
  std::string key;
};

void report(const CheckOptions& options, bool valid, const std::string& message) {
  if (!options.json.empty()) {
    const nlohmann::json result{{"file", options.blob}, {"valid", valid}, {"message", message}};
    support::write_file(options.json, support::json_text(result));
  }
}

/// Throws if the blob has an invalid signature. With --key, also throws if it has no signature or
/// that of another key.
void check_signature(const CheckOptions& options, const support::BlobFile& blob) {
  const std::optional<ModelSignature> signature = read_signature(options.blob);
  if (!signature) {
    if (!options.key.empty()) {
      throw support::UserError(
          fmt::format("{}: not signed (sign it with `tactree sign`)", options.blob));
    }
    return;
  }
  const std::string file = signature_path(options.blob).string();
  if (!is_valid(*signature, blob.bytes())) {
    throw support::UserError(
        fmt::format("{}: not a valid signature of this blob (sign it again with "
                    "`tactree sign`)",
                    file));
  }
  if (!options.key.empty() && read_public_key(options.key) != signature->key) {
    throw support::UserError(
        fmt::format("{}: signed by {}, not by the key of {} (sign it with that key)", file,
                    to_hex(signature->key), options.key));
  }
  fmt::print("{}: valid: {}\n", file, describe(*signature));
}

void check(const CheckOptions& options) {
  support::check_outputs({options.json}, {options.blob, options.key, signature_path(options.blob)});
  try {
    const support::BlobFile blob = support::BlobFile::named(options.blob);
    const std::string message =
        fmt::format("{}: valid: {} points in {} leaves, {} bytes, checksum {:08x}", options.blob,
                    blob.view().point_count(), blob.view().header().leaf_count, blob.bytes().size(),
                    blob.view().header().checksum);
    fmt::print("{}\n", message);
    check_signature(options, blob);
    report(options, true, message);
  } catch (const support::UserError& error) {
    report(options, false, error.what());
    throw;
  }
}

}  // namespace

void add_check_command(CLI::App& app, int&) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* verb = app.add_subcommand(
      "check", "Validates a blob with the checks of the controller; exit code 0 if it is valid");
  verb->add_option("BLOB", options->blob, "blob to check; -: standard input")->required();
  verb->add_option("--key", options->key, "require a signature by this public key")
      ->check(existing_file());
  verb->add_option("--json", options->json, "write the result as JSON to this file");
  verb->callback([options] { check(*options); });
}

}  // namespace tactree::cli
