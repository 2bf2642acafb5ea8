#include "check_command.hpp"

#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "blob_file.hpp"
#include "command.hpp"
#include "json_text.hpp"
#include "output_file.hpp"

namespace tactree::cli {
namespace {

struct CheckOptions {
  std::string blob;
  std::string json;
};

void report(const CheckOptions& options, bool valid, const std::string& message) {
  if (!options.json.empty()) {
    const nlohmann::json result{{"file", options.blob}, {"valid", valid}, {"message", message}};
    write_file(options.json, json_text(result));
  }
}

void check(const CheckOptions& options) {
  try {
    const BlobFile blob(options.blob);
    const std::string message =
        fmt::format("{}: valid: {} points in {} leaves, {} bytes, checksum {:08x}", options.blob,
                    blob.view().point_count(), blob.view().header().leaf_count, blob.bytes().size(),
                    blob.view().header().checksum);
    fmt::print("{}\n", message);
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
  verb->add_option("--json", options->json, "write the verdict to this file");
  verb->callback([options] { check(*options); });
}

}  // namespace tactree::cli
