#pragma once
// `tactree build --collection`: one blob per scan of a list or folder.
//
// Several processes share the output folder without locks. Each object has separate files, which
// are written completely or not at all, its row last. A row whose digests are those of the scan, of
// the options and of the blob is up to date, so a process that was killed can be started again.

#include <filesystem>
#include <string>

#include "scan/board_build.hpp"
#include "tactree/builder/build_model.hpp"

namespace tactree::cli {

struct CollectionRequest {
  std::string collection;        ///< list or folder; empty: none
  std::string part;              ///< "K/N"; empty: from the environment
  bool collect = false;          ///< build nothing, write the overview of what is there
  std::filesystem::path output;  ///< folder; created if necessary
  std::filesystem::path json;    ///< summary; empty: none
  std::string options_digest;
};

/// Builds the objects of the part that are not up to date, each in a child process, and writes the
/// overview if the part is the whole collection. Prints one line per object, and the failures at
/// the end. Returns false if an object failed, or with `collect` is missing. Throws UserError and
/// CLI::ValidationError.
[[nodiscard]] bool build_collection(const CollectionRequest& request,
                                    const builder::BuildOptions& build, const BoardRequest& board,
                                    builder::ProgressStyle progress);

}  // namespace tactree::cli
