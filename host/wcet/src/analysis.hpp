#pragma once
// Shared by all parts of one analysis: the image, its sources, and the values of names.

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "image.hpp"
#include "program.hpp"
#include "source_code.hpp"
#include "tactree/wcet/bound.hpp"

namespace tactree::wcet {

/// Functions by address, and how often each is entered.
using Entries = std::map<std::uint32_t, double>;

struct Analysis {
  const Image& image;
  const SourceCode& sources;
  Program& program;
  const Parameters& parameters;
  std::set<std::string> inlined;  ///< symbols of functions that are inlined somewhere
  /// Parameters that a formula leaves open, with their largest values. Empty: none.
  Parameters open;
  const BoardTiming* timing;  ///< the cost is in cycles; nullptr: in instructions
};

/// True if an annotation states that the instruction's data are in RAM.
[[nodiscard]] bool is_in_ram(const Analysis& analysis, const Instruction& instruction);

/// Values of the names in annotations, for one call with constant arguments.
class NameValues {
 public:
  /// Both outlive the object.
  NameValues(const Analysis& analysis, const Parameters& arguments)
      : analysis_(analysis), arguments_(arguments) {}

  /// Not less than 0. `file` is where the expression stands. Throws BoundError.
  [[nodiscard]] std::int64_t value(const Expression& expression, const std::string& file) const;
  /// With these values of the open parameters; those not in `open` are 0.
  [[nodiscard]] std::int64_t value_with(const Expression& expression, const std::string& file,
                                        const Parameters& open) const;
  /// Of the function's own arguments; nullopt: not constant.
  [[nodiscard]] std::optional<std::int64_t> argument(const std::string& name) const;

 private:
  [[nodiscard]] std::optional<std::int64_t> find(const std::string& name,
                                                 const std::string& file) const;

  const Analysis& analysis_;
  const Parameters& arguments_;
};

}  // namespace tactree::wcet
