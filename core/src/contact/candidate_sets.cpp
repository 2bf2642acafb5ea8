// Which of two candidate sets is in use, and where the other one is gathered.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/contact/candidate_sets.hpp"

namespace tactree::core {

[[gnu::noinline]] bool CandidateSets::take_other(Vec3 x) {
  if (!spare().covers(x)) {
    return false;
  }
  used_ = 1U - used_;
  show_all();
  return true;
}

[[gnu::noinline]] bool CandidateSets::other_will_cover(Vec3 x) const {
  return spare().will_cover(x);
}

[[gnu::noinline]] void CandidateSets::begin_on_demand(const BlobView& view, Vec3 x) {
  CandidateSet& set = sets_[place_of_gather()];
  if (!set.is_gathering() || (is_ahead_ && !set.will_cover(x))) {
    set.begin(view, in_use().centre_for(view, x));
  }
  is_ahead_ = false;
}

// The path leaves the ball of the set in use at the distance `exit` from x. The centre of the
// second ball is beyond: it begins before the exit, and before the next query.
[[gnu::noinline]] bool CandidateSets::begin_ahead(const BlobView& view, Vec3 x, Vec3 travel) {
  CandidateSet& set = sets_[place_of_gather()];
  if (set.is_gathering()) {
    is_ahead_ = true;
    return true;
  }
  const float distance = length(travel);
  if (!(distance > 0.0F)) {
    return false;
  }
  const Vec3 direction = (1.0F / distance) * travel;
  const float slack = CandidateSet::slack_of(view);
  const Vec3 from_centre = x - in_use().centre();
  const float along = dot(from_centre, direction);
  const float inside = slack * slack - length_squared(from_centre) + along * along;
  const float exit = square_root(inside > 0.0F ? inside : 0.0F) - along;
  const float next = exit > distance ? exit : distance;
  if (!(exit < kTicksAhead * distance) || set.covers(x + next * direction)) {
    return false;
  }
  set.begin(view, x + (next + kCentreAhead * slack) * direction);
  is_ahead_ = true;
  return true;
}

bool CandidateSets::continue_gather(const BlobView& view, GatherSlice& left) {
  const std::uint32_t place = place_of_gather();
  if (!sets_[place].gather(view, left)) {
    return false;
  }
  used_ = is_ahead_ ? used_ : place;
  return true;
}

}  // namespace tactree::core
