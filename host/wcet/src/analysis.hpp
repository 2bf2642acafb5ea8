#pragma once
// Data that all steps of an analysis share: the image, its sources, and the values of names.

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

/// Number of entries of each function, by address.
using Entries = std::map<std::uint32_t, double>;

/// Parameters that a formula leaves open, with their minimum and maximum values.
struct OpenParameters {
  Parameters least;
  Parameters largest;
};

struct Analysis {
  const Image& image;
  const SourceCode& sources;
  Program& program;
  const Parameters& parameters;
  std::set<std::string> inlined;  ///< symbols of functions that are inlined somewhere
  OpenParameters open;
  const BoardTiming* timing;  ///< if nullptr, the cost is in instructions, otherwise in cycles
};

/// True if an annotation states that the instruction's data are in RAM.
[[nodiscard]] bool is_in_ram(const Analysis& analysis, const Instruction& instruction);

/// Values of the names in annotations, for one call with constant arguments.
class NameValues {
 public:
  /// Both must outlive the object.
  NameValues(const Analysis& analysis, const Parameters& arguments)
      : analysis_(analysis), arguments_(arguments) {}

  /// Value of an expression in `file`, at least 0. Throws BoundError.
  [[nodiscard]] std::int64_t value(const Expression& expression, const std::string& file) const;
  /// Value of an expression with these values of the open parameters; the others are 0.
  [[nodiscard]] std::int64_t value_with(const Expression& expression, const std::string& file,
                                        const Parameters& values) const;
  /// Value of an argument of the function; nullopt if it is not constant.
  [[nodiscard]] std::optional<std::int64_t> argument(const std::string& name) const;

 private:
  [[nodiscard]] std::optional<std::int64_t> find(const std::string& name,
                                                 const std::string& file) const;

  const Analysis& analysis_;
  const Parameters& arguments_;
};

}  // namespace tactree::wcet
