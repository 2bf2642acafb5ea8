#pragma once
// The part of a collection that one of several processes builds.

#include <cstddef>
#include <string>

namespace tactree::cli {

struct CollectionPart {
  std::size_t number = 1;  ///< 1 .. count
  std::size_t count = 1;
  std::string origin;  ///< the option or the variables that state it; empty: none

  /// Every object is in exactly one part. Neighbours in the order of names, whose sizes are often
  /// similar, are in different parts.
  [[nodiscard]] bool has(std::size_t object) const { return object % count == number - 1; }
};

/// `option` is the value of --part, "K/N". If it is empty, the environment variables of a Slurm
/// array job, of Open MPI or of a launcher with PMI determine the part; without them it is 1/1.
/// Throws CLI::ValidationError for an invalid option, and UserError for variables that do not
/// determine one part.
[[nodiscard]] CollectionPart choose_part(const std::string& option);

}  // namespace tactree::cli
