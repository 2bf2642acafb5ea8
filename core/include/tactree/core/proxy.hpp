#pragma once
// The god-object: a point that stays on the surface while the probe goes through it. The force on
// the hand pulls the probe to the proxy. (Zilles and Salisbury, "A constraint-based god-object
// method for haptic display", IROS 1995; friction after Harwin and Melder, EuroHaptics 2002.)
//
// FREE:    the way of the probe is swept in steps of half a support radius, so that nothing is
//          crossed unnoticed; where the signed distance turns negative, contact begins.
// CONTACT: the proxy sticks within the friction cone of the probe, or slips to its rim.
// What a tick may cost is given. No step takes more than one gather: with work_per_tick() and
// R = 2.5 mm it keeps up with 5 m/s at 1 kHz, 2.5 m/s at 2 kHz and 1.2 m/s at 4 kHz; a faster probe
// is followed with a delay, never lost. Where a gather leaves no work for the fit, that follows in
// the next tick; a proxy in contact glides on along the tangent plane meanwhile.

#include <cstdint>

#include "tactree/core/blob.hpp"
#include "tactree/core/surface.hpp"

namespace tactree::core {

/// Coefficients, 0 <= dynamic <= static.
struct Friction {
  float static_coefficient = 0.0F;
  float dynamic_coefficient = 0.0F;
};

class Proxy {
 public:
  /// Forgets model, contact and side; the proxy is at `probe`. Call it when the model changes.
  void reset(Vec3 probe);

  /// Follows the probe for one tick. Cost: `work`, and for each of its gathers one search for the
  /// nearest candidate.
  void update(const BlobView& view, Vec3 probe, const Friction& friction, const SurfaceWork& work);

  [[nodiscard]] bool in_contact() const { return in_contact_; }
  /// In contact: the probe left the object, or an open surface, from its inner side.
  [[nodiscard]] bool from_behind() const { return in_contact_ && side_ < 0.0F; }
  [[nodiscard]] bool slipping() const { return slipping_; }
  /// In contact: on the surface. Free: where the sweep has got to, the probe as a rule.
  [[nodiscard]] Vec3 position() const { return position_; }
  /// In contact: of the surface, towards the side the probe came from.
  [[nodiscard]] Vec3 normal() const { return side_ * reference_; }
  /// In contact: of the surface, towards the side of the points' normals.
  [[nodiscard]] Vec3 stored_normal() const { return reference_; }
  /// The points around position().
  [[nodiscard]] const CandidateSet& candidates() const { return candidates_; }
  /// Share of the contact force to display: less than 1 where the surface ends.
  [[nodiscard]] float strength() const { return strength_; }
  /// True in the tick in which contact ended because the surface did, not because the probe left.
  [[nodiscard]] bool lost_contact() const { return lost_contact_; }
  /// False once a gather had to leave points out; reset() makes it true.
  [[nodiscard]] bool complete() const { return complete_; }

 private:
  [[nodiscard]] bool may_fit() const;
  [[nodiscard]] bool may_gather() const;
  [[nodiscard]] bool gather(const BlobView& view, Vec3 x);
  [[nodiscard]] bool go_on(const BlobView& view, Vec3 x);
  void spend(std::uint32_t passes);
  [[nodiscard]] SurfaceFit evaluate(const BlobView& view, Vec3 x, Vec3 reference);
  void sweep(const BlobView& view, Vec3 probe);
  void visit(const BlobView& view, Vec3 x);
  void begin_contact(const BlobView& view, const SurfaceFit& fit);
  void slide(const BlobView& view, Vec3 probe, const Friction& friction);
  void glide_by(Vec3 step);
  [[nodiscard]] bool slip_by(const BlobView& view, Vec3 step);
  /// A Newton step onto the surface, where there is one.
  SurfaceFit settle(const BlobView& view);
  void release();
  void lose_support();

  CandidateSet candidates_;
  Vec3 position_{};
  Vec3 reference_{};   // normal of the last fit, as stored: towards the side of the points' normals
  float side_ = 1.0F;  // +1 or -1: on which side of the points' normals the probe is
  float strength_ = 0.0F;
  Vec3 next_{};         // where the sweep goes on, when the candidates there waited for this tick
  SurfaceWork left_{};  // for the rest of this tick
  std::uint32_t searches_left_ = 0;  // likewise: for the nearest candidate
  bool tracked_ = false;             // reference_ and side_ hold
  bool turned_ = false;              // not tracked, but reference_ says which way to look
  bool has_next_ = false;            // next_ holds
  bool unsettled_ = false;           // position_ wants a fit of its own
  bool in_contact_ = false;
  bool slipping_ = false;
  bool lost_contact_ = false;
  bool complete_ = true;
};

}  // namespace tactree::core
