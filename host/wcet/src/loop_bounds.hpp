#pragma once
// Maps loops of the machine code to loops of the source, which have the bounds.

#include <cstdint>
#include <map>
#include <vector>

#include "control_flow.hpp"
#include "image.hpp"
#include "source_code.hpp"

namespace tactree::wcet {

/// Where a loop of machine code evaluates the condition of its source loop.
enum class LoopShape {
  kAtEnd,    ///< each pass of the header is a pass of the body
  kAtStart,  ///< the header decides whether there is another pass of the body
  kUnknown,  ///< the condition may be evaluated once more than the body is passed
};

struct LoopBound {
  const SourceLoop* source = nullptr;
  LoopShape shape = LoopShape::kUnknown;
  /// Number of this loop, or of the enclosing loop if the compiler made two nested loops of one:
  /// the passes of both count as those of the source loop.
  std::uint32_t counts_with = 0;
};

/// Source lines of instructions, with names relative to the root of the sources; cached.
class Lines {
 public:
  Lines(const Image& image, SourceCode& sources) : image_(image), sources_(sources) {}
  [[nodiscard]] const std::vector<Place>& at(std::uint32_t address);

 private:
  const Image& image_;
  SourceCode& sources_;
  std::map<std::uint32_t, std::vector<Place>> known_;
};

/// One for each loop of `flow`. Throws BoundError on a loop that has no source loop, several
/// candidates, or no bound.
[[nodiscard]] std::vector<LoopBound> find_loop_bounds(const Image& image, const ControlFlow& flow,
                                                      const SourceCode& sources, Lines& lines);

}  // namespace tactree::wcet
