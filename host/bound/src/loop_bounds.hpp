#pragma once
// Which loop of the source a loop of the machine code is, and what its annotation says about it.

#include <cstdint>
#include <map>
#include <vector>

#include "control_flow.hpp"
#include "image.hpp"
#include "source_code.hpp"

namespace tactree::bound {

/// Where a loop of machine code evaluates the condition of its source.
enum class LoopShape {
  kAtEnd,    ///< each pass of the header is a pass of the body
  kAtStart,  ///< the header decides whether there is another pass of the body
  kUnknown,  ///< it may be evaluated once more than the body is passed
};

struct LoopBound {
  const SourceLoop* source = nullptr;
  LoopShape shape = LoopShape::kUnknown;
  /// The compiler made two nested loops of one: their passes count together, as this loop's.
  std::uint32_t counts_with = 0;
};

/// The places of an image's instructions, as names below the sources' root; looked up once each.
class Lines {
 public:
  Lines(const Image& image, SourceCode& sources) : image_(image), sources_(sources) {}
  [[nodiscard]] const std::vector<Place>& at(std::uint32_t address);

 private:
  const Image& image_;
  SourceCode& sources_;
  std::map<std::uint32_t, std::vector<Place>> known_;
};

/// One for each loop of `flow`. Throws BoundError on a loop that is none of the source, or that
/// has no annotation.
[[nodiscard]] std::vector<LoopBound> find_loop_bounds(const Image& image, const ControlFlow& flow,
                                                      const SourceCode& sources, Lines& lines);

}  // namespace tactree::bound
