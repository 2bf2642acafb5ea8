#include "check_command.hpp"

#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "blob_file.hpp"
#include "command.hpp"
#include "json_text.hpp"
#include "model_signature.hpp"
#include "output_file.hpp"

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
    write_file(options.json, json_text(result));
  }
}

/// Where the blob is signed, the signature has to be right; and by the owner of --key.
void check_signature(const CheckOptions& options, const BlobFile& blob) {
  const std::optional<ModelSignature> signature = read_signature(options.blob);
  if (!signature) {
    if (!options.key.empty()) {
      throw CommandError(fmt::format("{}: not signed (tactree sign)", options.blob));
    }
    return;
  }
  const std::string file = signature_path(options.blob).string();
  if (!is_valid(*signature, blob.bytes())) {
    throw CommandError(
        fmt::format("{}: this is not the signature of this blob (sign it again: "
                    "tactree sign)",
                    file));
  }
  if (!options.key.empty() && read_public_key(options.key) != signature->key) {
    throw CommandError(fmt::format("{}: signed by {}, not by the owner of {}", file,
                                   to_hex(signature->key), options.key));
  }
  fmt::print("{}: valid: {}\n", file, describe(*signature));
}

void check(const CheckOptions& options) {
  try {
    const BlobFile blob(options.blob);
    const std::string message =
        fmt::format("{}: valid: {} points in {} leaves, {} bytes, checksum {:08x}", options.blob,
                    blob.view().point_count(), blob.view().header().leaf_count, blob.bytes().size(),
                    blob.view().header().checksum);
    fmt::print("{}\n", message);
    check_signature(options, blob);
    report(options, true, message);
  } catch (const CommandError& error) {
    report(options, false, error.what());
    throw;
  }
}

}  // namespace

void add_check_command(CLI::App& app, int&) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* verb = app.add_subcommand(
      "check", "Validates a blob as the controller does before it loads one; exit code 0 = valid");
  verb->add_option("BLOB", options->blob, "the blob to check")->required();
  verb->add_option("--key", options->key, "public key of who must have signed it")
      ->check(CLI::ExistingFile);
  verb->add_option("--json", options->json, "write the verdict to this file");
  verb->callback([options] { check(*options); });
}

}  // namespace tactree::cli
