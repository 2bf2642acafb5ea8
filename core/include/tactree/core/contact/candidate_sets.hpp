#pragma once
// The candidates of a proxy: the set in use and, at rates at which a gather takes several ticks, a
// second set that is gathered meanwhile.
//
//   on demand   a query has left the set in use and waits for the second set
//   ahead       no query waits: the second set is gathered around the position at which the query
//               will leave the set in use
//
// At other rates one set is enough. It is gathered on demand, in place.
//
// Interrupt safety: no shared state; one context owns the sets.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

#include "tactree/core/contact/candidates.hpp"
#include "tactree/core/contact/surface_work.hpp"
#include "tactree/core/math/vec3.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::core {

class CandidateSets {
 public:
  /// Empties both sets and makes complete() true. Required whenever the blob changes.
  void clear() {
    sets_[0].clear();
    sets_[1].clear();
    is_ahead_ = false;
  }
  /// Required before the other calls of a tick: whether the second set is used. A change empties
  /// both sets.
  void use_both(bool both) {
    if (both != both_) {
      clear();
      both_ = both;
    }
  }
  [[nodiscard]] bool uses_both() const { return both_; }

  /// The set of the last fit, or that of a gather which has ended since.
  [[nodiscard]] const CandidateSet& in_use() const { return sets_[used_]; }
  /// Takes the second set into use, without hidden points, if it covers `x`.
  bool take_other(Vec3 x);
  /// A set covers `x`, now or after the gather in progress.
  [[nodiscard, gnu::always_inline]] bool will_cover(Vec3 x) const {
    // at most: ahead * 2 per Proxy::update
    return in_use().will_cover(x) || (both_ && other_will_cover(x));
  }

  /// Begins a gather on demand for a query at `x`, unless one is in progress. A gather ahead that
  /// will cover `x` becomes one on demand; another one is abandoned.
  void begin_on_demand(const BlobView& view, Vec3 x);
  /// Begins a gather ahead if a query at `x` that moves by `travel` (m) per tick will leave the set
  /// in use within kTicksAhead ticks, and no set covers the position at which it does. Returns true
  /// during a gather. Precondition: uses_both(). Cost: about 60 operations.
  [[nodiscard]] bool begin_ahead(const BlobView& view, Vec3 x, Vec3 travel);
  /// Continues the gather in progress. Returns true if it has ended; a gather on demand is then in
  /// use. Cost: CandidateSet::gather().
  bool continue_gather(const BlobView& view, GatherSlice& left);

  /// True during a gather on demand.
  [[nodiscard]] bool is_waiting() const { return !is_ahead_ && gathered().is_gathering(); }
  /// False after a gather or a fit that omitted points; clear() makes it true.
  [[nodiscard]] bool complete() const { return sets_[0].complete() && sets_[1].complete(); }
  void report_omission() { sets_[used_].report_omission(); }

  /// Of the set in use: see CandidateSet.
  void hide(const Neighbour& neighbour, float side) { sets_[used_].hide(neighbour, side); }
  void show_all() { sets_[used_].show_all(); }

  /// A gather ahead begins if the query leaves the set in use within this number of ticks. A gather
  /// of a plane takes up to 13 slices; with 12 ticks, a slow query waited for some of them.
  static constexpr float kTicksAhead = 16.0F;

 private:
  [[nodiscard]] bool other_will_cover(Vec3 x) const;
  [[nodiscard]] const CandidateSet& spare() const { return sets_[1U - used_]; }
  [[nodiscard]] std::uint32_t place_of_gather() const { return both_ ? 1U - used_ : used_; }
  [[nodiscard]] const CandidateSet& gathered() const { return sets_[place_of_gather()]; }

  std::uint32_t used_ = 0;
  bool both_ = false;
  bool is_ahead_ = false;  // no query waits for the gather in progress
  CandidateSet sets_[2];
};

}  // namespace tactree::core
