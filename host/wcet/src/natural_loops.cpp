// Finds the loops of a control flow graph by its dominators.
#include <algorithm>

#include "control_flow.hpp"

namespace tactree::wcet {
namespace {

/// Precondition: all blocks are reachable from block 0.
class LoopFinder {
 public:
  LoopFinder(const Image& image, ControlFlow& flow)
      : image_(image), flow_(flow), before_(flow.blocks.size()) {
    for (std::uint32_t b = 0; b < flow_.blocks.size(); ++b) {
      for (const std::uint32_t next : flow_.blocks[b].next) {
        before_[next].push_back(b);
      }
    }
  }

  void find() {
    find_dominators();
    std::map<std::uint32_t, NaturalLoop> by_header;
    std::vector<Edge> irregular;
    for (const Edge& edge : retreating_edges()) {
      if (!dominators_[edge.first].contains(edge.second)) {
        irregular.push_back(edge);
        continue;
      }
      NaturalLoop& loop = by_header[edge.second];
      loop.header = edge.second;
      loop.back.push_back(edge);
      collect(loop, edge.first);
    }
    for (auto& [header, loop] : by_header) {
      flow_.loops.push_back(std::move(loop));
    }
    for (const Edge& edge : irregular) {
      add_irregular(edge);
    }
    nest();
  }

 private:
  void find_dominators() {
    std::set<std::uint32_t> all;
    for (std::uint32_t b = 0; b < flow_.blocks.size(); ++b) {
      all.insert(b);
    }
    dominators_.assign(flow_.blocks.size(), all);
    dominators_[0] = {0};
    for (bool changed = true; changed;) {
      changed = false;
      for (std::uint32_t b = 1; b < flow_.blocks.size(); ++b) {
        std::set<std::uint32_t> common = dominators_[before_[b][0]];
        for (const std::uint32_t p : before_[b]) {
          std::erase_if(common, [&](std::uint32_t d) { return !dominators_[p].contains(d); });
        }
        common.insert(b);
        changed = changed || common != dominators_[b];
        dominators_[b] = std::move(common);
      }
    }
  }

  /// Edges to a block on the current path of a depth-first search.
  std::vector<Edge> retreating_edges() {
    std::vector<Edge> result;
    std::vector<int> state(flow_.blocks.size(), 0);  // 1: on the path, 2: done
    std::vector<std::pair<std::uint32_t, std::size_t>> path{{0, 0}};
    state[0] = 1;
    while (!path.empty()) {
      const std::uint32_t block = path.back().first;
      const auto& next = flow_.blocks[block].next;
      if (path.back().second == next.size()) {
        state[block] = 2;
        path.pop_back();
        continue;
      }
      const std::uint32_t to = next[path.back().second++];
      if (state[to] == 1) {
        result.emplace_back(block, to);
      } else if (state[to] == 0) {
        state[to] = 1;
        path.emplace_back(to, 0);
      }
    }
    return result;
  }

  void collect(NaturalLoop& loop, std::uint32_t from) const {
    loop.blocks.insert(loop.header);
    std::vector<std::uint32_t> open{from};
    while (!open.empty()) {
      const std::uint32_t block = open.back();
      open.pop_back();
      if (loop.blocks.insert(block).second) {
        open.insert(open.end(), before_[block].begin(), before_[block].end());
      }
    }
  }

  /// Adds a loop with several entries. Throws BoundError if no block is on every path around it.
  void add_irregular(const Edge& edge) {
    for (const NaturalLoop& known : flow_.loops) {
      if (known.irregular && known.blocks.contains(edge.first)) {
        return;
      }
    }
    NaturalLoop loop;
    loop.irregular = true;
    loop.blocks = round_trip(edge.first, room_of(edge));
    std::erase_if(flow_.loops,
                  [&](const NaturalLoop& inner) { return includes(loop.blocks, inner.blocks); });
    for (const std::uint32_t b : loop.blocks) {
      if (is_on_every_round(b, loop.blocks)) {
        loop.header = b;
        for (const std::uint32_t from : before_[b]) {
          if (loop.blocks.contains(from)) {
            loop.back.emplace_back(from, b);
          }
        }
        flow_.loops.push_back(std::move(loop));
        return;
      }
    }
    refuse_at(image_, flow_.instructions[flow_.blocks[edge.second].first].address,
              "loop with several entries and no common block (write it as separate loops)");
  }

  static bool includes(const std::set<std::uint32_t>& all, const std::set<std::uint32_t>& some) {
    return std::includes(all.begin(), all.end(), some.begin(), some.end());
  }

  /// Blocks that a loop through this edge may contain: those of the smallest enclosing loop
  /// without its header.
  [[nodiscard]] std::set<std::uint32_t> room_of(const Edge& edge) const {
    std::set<std::uint32_t> room;
    for (std::uint32_t b = 0; b < flow_.blocks.size(); ++b) {
      room.insert(b);
    }
    for (const NaturalLoop& loop : flow_.loops) {
      std::set<std::uint32_t> inner = loop.blocks;
      inner.erase(loop.header);
      if (inner.contains(edge.first) && inner.contains(edge.second) && inner.size() < room.size()) {
        room = std::move(inner);
      }
    }
    return room;
  }

  /// Blocks of `room` that reach `block` and are reached from it.
  [[nodiscard]] std::set<std::uint32_t> round_trip(std::uint32_t block,
                                                   const std::set<std::uint32_t>& room) const {
    const auto reached = [&](const auto& next_of) {
      std::set<std::uint32_t> seen{block};
      std::vector<std::uint32_t> open{block};
      while (!open.empty()) {
        const std::uint32_t here = open.back();
        open.pop_back();
        for (const std::uint32_t next : next_of(here)) {
          if (room.contains(next) && seen.insert(next).second) {
            open.push_back(next);
          }
        }
      }
      return seen;
    };
    std::set<std::uint32_t> both = reached([&](std::uint32_t b) { return flow_.blocks[b].next; });
    const std::set<std::uint32_t> to = reached([&](std::uint32_t b) { return before_[b]; });
    std::erase_if(both, [&](std::uint32_t b) { return !to.contains(b); });
    return both;
  }

  [[nodiscard]] bool is_on_every_round(std::uint32_t block,
                                       const std::set<std::uint32_t>& blocks) const {
    std::set<std::uint32_t> left = blocks;
    left.erase(block);
    // Repeatedly removes blocks without a predecessor among those left.
    for (bool changed = true; changed;) {
      const std::size_t count = left.size();
      std::erase_if(left, [&](std::uint32_t b) {
        return std::none_of(before_[b].begin(), before_[b].end(),
                            [&](std::uint32_t from) { return left.contains(from); });
      });
      changed = left.size() != count;
    }
    return left.empty();
  }

  void nest() {
    auto& loops = flow_.loops;
    std::sort(loops.begin(), loops.end(), [](const NaturalLoop& a, const NaturalLoop& b) {
      return std::pair(b.blocks.size(), a.header) < std::pair(a.blocks.size(), b.header);
    });
    for (std::uint32_t i = 0; i < loops.size(); ++i) {
      for (std::uint32_t outer = 0; outer < i; ++outer) {
        if (loops[outer].blocks.contains(loops[i].header)) {
          loops[i].parent = outer;  // the last is the smallest
        }
      }
      for (const std::uint32_t b : loops[i].blocks) {
        for (const std::uint32_t from : before_[b]) {
          if (!loops[i].blocks.contains(from)) {
            loops[i].entries.emplace_back(from, b);
          }
        }
      }
    }
  }

  const Image& image_;
  ControlFlow& flow_;
  std::vector<std::vector<std::uint32_t>> before_;
  std::vector<std::set<std::uint32_t>> dominators_;
};

}  // namespace

void find_loops(const Image& image, ControlFlow& flow,
                const std::set<std::uint32_t>& never_return) {
  for (Block& block : flow.blocks) {
    if (block.calls && never_return.contains(*block.calls)) {
      block.next.clear();
      block.returns = false;
    }
  }
  drop_unreachable(flow);
  for (const Block& block : flow.blocks) {
    if (block.runs_out) {
      refuse_at(image, flow.instructions[block.first].address,
                "runs past the end of its function (build the image with correct symbol sizes)");
    }
  }
  LoopFinder(image, flow).find();
}

}  // namespace tactree::wcet
