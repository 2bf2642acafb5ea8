#include "loop_bounds.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <set>

#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {
namespace {

bool is_head(const SourceLoop& loop, const Place& place) {
  return loop.file == place.file &&
         std::find(loop.head.begin(), loop.head.end(), place.line) != loop.head.end();
}

bool within(const SourceLoop& loop, const Place& place) {
  return loop.file == place.file && place.line >= loop.line && place.line <= loop.last;
}

class Matcher {
 public:
  Matcher(const Image& image, const ControlFlow& flow, const SourceCode& sources, Lines& lines)
      : image_(image), flow_(flow), sources_(sources), lines_(lines) {}

  std::vector<LoopBound> match() {
    for (std::uint32_t i = 0; i < flow_.loops.size(); ++i) {
      result_.push_back(match(i));
    }
    return std::move(result_);
  }

 private:
  LoopBound match(std::uint32_t number) {
    LoopBound bound;
    bound.counts_with = number;
    const std::set<std::uint32_t> own = own_blocks(number);
    Heads heads = heads_among(control_instructions(number, own));
    without_outer(number, heads);
    if (heads.empty()) {
      heads = heads_among(all_instructions(own));
      const Heads with_outer = heads;
      without_outer(number, heads);
      if (heads.empty() && !with_outer.empty()) {
        return second_of(number, with_outer);
      }
    }
    bound.source = outermost(number, heads);
    if (!bound.source->bound) {
      throw BoundError(
          fmt::format("{}:{}: a loop that has no bound (write `// bound: ...` beside it)",
                      bound.source->file, bound.source->line));
    }
    bound.shape = shape_of(number, *bound.source);
    return bound;
  }

  /// Source loops, each with the instructions of its head.
  using Heads = std::map<const SourceLoop*, std::vector<std::uint32_t>, SourceOrder>;

  /// Blocks of the loop that are not in an inner loop.
  [[nodiscard]] std::set<std::uint32_t> own_blocks(std::uint32_t number) const {
    std::set<std::uint32_t> own = flow_.loops[number].blocks;
    for (const NaturalLoop& inner : flow_.loops) {
      if (inner.parent == number) {
        std::erase_if(own, [&](std::uint32_t b) { return inner.blocks.contains(b); });
      }
    }
    return own;
  }

  [[nodiscard]] bool exits(std::uint32_t number, std::uint32_t block) const {
    const auto& next = flow_.blocks[block].next;
    return std::any_of(next.begin(), next.end(),
                       [&](std::uint32_t b) { return !flow_.loops[number].blocks.contains(b); });
  }

  /// Address of the conditional branch that ends a block; nullopt if there is none.
  [[nodiscard]] std::optional<std::uint32_t> branch(std::uint32_t b) const {
    const Block& block = flow_.blocks[b];
    if (block.count == 0) {
      return std::nullopt;
    }
    const Instruction& last = flow_.instructions[block.first + block.count - 1];
    return last.conditional_branch ? std::optional(last.address) : std::nullopt;
  }

  /// Branches that leave or close the loop, which evaluate its condition.
  [[nodiscard]] std::vector<std::uint32_t> control_instructions(
      std::uint32_t number, const std::set<std::uint32_t>& own) const {
    std::vector<std::uint32_t> result;
    for (const std::uint32_t b : own) {
      const auto& next = flow_.blocks[b].next;
      const bool closes =
          std::find(next.begin(), next.end(), flow_.loops[number].header) != next.end();
      const auto address = branch(b);
      if (address && (closes || exits(number, b))) {
        result.push_back(*address);
      }
    }
    return result;
  }

  [[nodiscard]] std::vector<std::uint32_t> all_instructions(
      const std::set<std::uint32_t>& own) const {
    std::vector<std::uint32_t> result;
    for (const std::uint32_t b : own) {
      for (std::uint32_t i = 0; i < flow_.blocks[b].count; ++i) {
        result.push_back(flow_.instructions[flow_.blocks[b].first + i].address);
      }
    }
    return result;
  }

  Heads heads_among(const std::vector<std::uint32_t>& addresses) {
    Heads heads;
    for (const std::uint32_t address : addresses) {
      for (const Place& place : lines_.at(address)) {
        const SourceFile* const file = sources_.find(place.file);
        if (file == nullptr) {
          continue;
        }
        for (const SourceLoop& loop : file->loops) {
          if (is_head(loop, place)) {
            heads[&loop].push_back(address);
          }
        }
      }
    }
    return heads;
  }

  /// Removes the source loops of enclosing loops.
  void without_outer(std::uint32_t number, Heads& heads) const {
    for (auto outer = flow_.loops[number].parent; outer; outer = flow_.loops[*outer].parent) {
      heads.erase(result_[*outer].source);
    }
  }

  LoopBound second_of(std::uint32_t number, const Heads& heads) const {
    for (auto outer = flow_.loops[number].parent; outer; outer = flow_.loops[*outer].parent) {
      if (heads.contains(result_[*outer].source)) {
        LoopBound bound = result_[*outer];
        bound.shape = LoopShape::kUnknown;
        return bound;
      }
    }
    return {};  // not reached: the heads are those of enclosing loops
  }

  /// True if an instruction of the head `inner` lies in `outer` or in a function inlined there.
  [[nodiscard]] bool encloses(const SourceLoop& outer, const std::vector<std::uint32_t>& inner) {
    return std::any_of(inner.begin(), inner.end(), [&](std::uint32_t address) {
      const auto& places = lines_.at(address);
      return std::any_of(places.begin(), places.end(),
                         [&](const Place& place) { return within(outer, place); });
    });
  }

  /// Of several source loops, the one that contains the others, which are unrolled.
  const SourceLoop* outermost(std::uint32_t number, const Heads& heads) {
    std::vector<const SourceLoop*> found;
    for (const auto& [loop, of_it] : heads) {
      const bool within_another = std::any_of(
          heads.begin(), heads.end(), [&, loop = loop, &of_it = of_it](const auto& other) {
            return other.first != loop && encloses(*other.first, of_it) &&
                   !encloses(*loop, other.second);
          });
      if (!within_another) {
        found.push_back(loop);
      }
    }
    if (found.size() == 1) {
      return found[0];
    }
    const NaturalLoop& loop = flow_.loops[number];
    const std::string where =
        describe_place(image_, flow_.instructions[flow_.blocks[loop.header].first].address);
    if (found.empty()) {
      throw BoundError(
          where +
          ": a loop that matches no loop in the source (write it as one loop, with a "
          "bound beside its head; if it is part of a constructor, construct the object "
          "before the tick)");
    }
    std::string names;
    for (const SourceLoop* candidate : found) {
      names += fmt::format(" {}:{}", candidate->file, candidate->line);
    }
    throw BoundError(
        fmt::format("{}: a loop that matches several loops in the source:{} (separate them, e.g. "
                    "by gnu::noinline)",
                    where, names));
  }

  /// True if the branch that ends the block is the condition of the source loop.
  [[nodiscard]] bool is_condition(std::uint32_t block, const SourceLoop& source) {
    const auto address = branch(block);
    if (!address) {
      return false;
    }
    const auto& places = lines_.at(*address);
    return !places.empty() && is_head(source, places[0]);
  }

  LoopShape shape_of(std::uint32_t number, const SourceLoop& source) {
    const NaturalLoop& loop = flow_.loops[number];
    if (!source.one_comparison || source.is_empty || loop.irregular) {
      return LoopShape::kUnknown;
    }
    const bool at_end = std::all_of(loop.back.begin(), loop.back.end(), [&](const Edge& back) {
      return exits(number, back.first) && is_condition(back.first, source);
    });
    if (at_end) {
      return LoopShape::kAtEnd;
    }
    return exits(number, loop.header) && is_condition(loop.header, source) ? LoopShape::kAtStart
                                                                           : LoopShape::kUnknown;
  }

  const Image& image_;
  const ControlFlow& flow_;
  const SourceCode& sources_;
  Lines& lines_;
  std::vector<LoopBound> result_;
};

}  // namespace

const std::vector<Place>& Lines::at(std::uint32_t address) {
  const auto known = known_.find(address);
  if (known != known_.end()) {
    return known->second;
  }
  std::vector<Place>& places = known_[address];
  for (Place& place : image_.places(address)) {
    places.push_back({sources_.name_of(place.file), place.line});
  }
  return places;
}

std::vector<LoopBound> find_loop_bounds(const Image& image, const ControlFlow& flow,
                                        const SourceCode& sources, Lines& lines) {
  return Matcher(image, flow, sources, lines).match();
}

}  // namespace tactree::wcet
