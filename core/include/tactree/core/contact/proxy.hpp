#pragma once
// The proxy (god-object): a point that stays on the surface while the probe penetrates it. The
// contact force pulls the probe towards the proxy. (Zilles and Salisbury, "A constraint-based
// god-object method for haptic display", IROS 1995; friction after Harwin and Melder, EuroHaptics
// 2002.)
//
// Free:       the path of the probe is swept in steps of half a support radius, so that no surface
//             is crossed undetected. Contact begins where the signed distance becomes negative. A
//             step that leaves its face, as across a narrow gap, is repeated with the face at its
//             end.
// In contact: the proxy sticks within the friction cone of the probe, or slips to the boundary of
//             the cone. Where the surface is concave, up to three faces hold it: it moves to the
//             position in front of all of them that is closest to the probe.
//
//   state                     side known   in contact
//   kUntracked, kReferenced   no           no
//   kTracking                 yes          no
//   kSticking, kSlipping      yes          yes
//
// When tracking begins (at the start, after a jump or after a lost contact) behind a surface, the
// model determines whether the probe is in its material (interior.hpp). If so, the probe is
// followed without force, and contact begins only after it has left. Both sides of a sheet count as
// free.
//
// Two bodies near the probe share one proxy: that of the body in contact, which leads. It is held
// by the faces of both. The proxy of the other body follows the leading proxy instead of the probe
// and finds the faces of its body there. It takes the lead where the surface is that of its body.
//
// A step takes at most one gather. With work_per_tick() and a support radius of 2.5 mm the proxy
// keeps up with a probe at 5 m/s at 1 kHz and 2.5 m/s at 2 kHz. Above 2 kHz candidates are gathered
// ahead of the proxy (candidate_sets.hpp), so that most ticks fit the surface where it is. It
// follows a faster probe with a delay and never loses it. If the budget is exhausted between gather
// and fit, the fit follows in the next tick; until then a proxy in contact moves along the tangent
// plane.
//
// Interrupt safety: no shared state; one context owns a proxy.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

#include "tactree/core/contact/candidate_sets.hpp"
#include "tactree/core/contact/constraint_planes.hpp"
#include "tactree/core/contact/neighbour.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/core/contact/tick_budget.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::core {

/// Coefficients, 0 <= dynamic <= static.
struct Friction {
  float static_coefficient = 0.0F;
  float dynamic_coefficient = 0.0F;
};

class Proxy {
 public:
  /// Clears contact, side and candidates, and places the proxy at `probe`. Required whenever the
  /// model changes.
  void reset(Vec3 probe);

  /// Follows the probe (m, model frame) for one tick, or the proxy of a neighbour that leads. Cost:
  /// at most `work`, including the searches for the nearest candidate; with a neighbour, one
  /// additional pass per gather and one per tick.
  void update(const BlobView& view, Vec3 probe, const Friction& friction, const SurfaceWork& work,
              const Neighbour* neighbour = nullptr);

  /// State and faces of this proxy for the proxy of another body, in the frame of this model.
  [[nodiscard]] Neighbour as_neighbour(const BlobView& view) const;
  /// In contact: updates the faces of the neighbour and, if they came closer, moves the proxy in
  /// front of them.
  void yield_to(const Neighbour& neighbour);
  /// In contact: returns true if the surface at the proxy is that of the neighbour, whose proxy is
  /// `follower`.
  [[nodiscard]] bool belongs_to(const Proxy& follower, const Neighbour& neighbour,
                                Vec3 probe) const;
  /// Continues the contact of the leading neighbour at the position of its proxy, `from`, which
  /// then tracks the surface without contact.
  void take_over(const Neighbour& neighbour, Proxy& from);
  /// In contact, after the calls above: determines which faces hold the probe.
  void aim(Vec3 probe);
  /// Component of a contact force along the normals of the neighbour's faces.
  [[nodiscard]] Vec3 share_of_neighbour(Vec3 force) const;

  [[nodiscard]] bool in_contact() const { return state_ >= State::kSticking; }
  /// True if the proxy is in the material, without contact. Detected within two ticks.
  [[nodiscard]] bool inside() const { return inside_; }
  /// True if in contact with the back of a sheet, the side opposite to its normals.
  [[nodiscard]] bool from_behind() const { return in_contact() && side_ < 0.0F; }
  [[nodiscard]] bool slipping() const { return state_ == State::kSlipping; }
  /// m. In contact: on the surface. Free: the end of the sweep, normally the probe.
  [[nodiscard]] Vec3 position() const { return position_; }
  /// In contact: unit normal of the surface on the probe's side; where several faces hold the
  /// proxy, the common direction in which they push the probe.
  [[nodiscard]] Vec3 normal() const {
    return planes_.count > 1U ? common_normal_ : side_ * reference_;
  }
  /// In contact: unit normal of the surface on the side of the points' normals; where several faces
  /// hold the proxy, that of the main face.
  [[nodiscard]] Vec3 stored_normal() const { return reference_; }
  /// The points around position(), unless is_waiting().
  [[nodiscard]] const CandidateSet& candidates() const { return candidates_.in_use(); }
  /// True if the next fit waits for its candidates.
  [[nodiscard]] bool is_waiting() const { return candidates_.is_waiting(); }
  /// Scale factor of the contact force; below 1 at the boundary of the surface.
  [[nodiscard]] float strength() const { return strength_; }
  /// True in a tick in which the contact ended at the boundary of the surface, not by the probe
  /// leaving it.
  [[nodiscard]] bool lost_contact() const { return lost_contact_; }
  /// False after a gather that omitted points; reset() makes it true.
  [[nodiscard]] bool complete() const { return candidates_.complete(); }

 private:
  // The order matters: see is_tracking() and in_contact().
  enum class State : std::uint8_t {
    kUntracked,   // the nearest candidate provides the next reference
    kReferenced,  // reference_ holds for the next fit, which does not check it again
    kTracking,    // reference_ and side_ hold
    kSticking,
    kSlipping,
  };

  /// A settled position of the proxy and its surface, restored when a step is taken back.
  struct Footing {
    Vec3 position{};
    Vec3 reference{};
    NearFaces near{};
    ConstraintPlanes planes{};
    std::uint32_t foreign = 0;
    float strength = 0.0F;
  };

  /// How the probe pulls the proxy.
  struct Pull {
    bool released;   // the probe is in front of all faces
    Vec3 along;      // m, displacement of the proxy without friction
    float depth;     // m, of the probe below the faces that touch the proxy
    float distance;  // m, along these faces
  };

  [[nodiscard]] bool is_tracking() const { return state_ >= State::kTracking; }
  [[nodiscard]] bool gather(const BlobView& view, Vec3 x);
  void gather_ahead(const BlobView& view, Vec3 begin);
  [[nodiscard]] bool covers(Vec3 x);
  [[nodiscard]] bool prepare_fit(const BlobView& view, Vec3 x);
  [[nodiscard]] SurfaceFit evaluate(const BlobView& view, Vec3 x);
  void look_around(const BlobView& view);
  void look_behind(const BlobView& view);
  void sweep(const BlobView& view, Vec3 probe);
  void visit(const BlobView& view);
  [[nodiscard]] bool has_reference(const BlobView& view);
  [[nodiscard]] bool rejects(const SurfaceFit& fit, bool was_smooth);
  [[nodiscard]] bool passes_by(const SurfaceFit& fit, Vec3 step) const;
  [[nodiscard]] bool is_led() const { return neighbour_ != nullptr && neighbour_->leads; }
  void begin_beside(const Neighbour* neighbour);
  void hide_points(float radius);
  void hold(const SurfaceFit& fit);
  void hold_beside(const SurfaceFit& fit);
  void add_foreign(ConstraintPlanes& planes) const;
  void meet(const Neighbour* neighbour);
  [[nodiscard]] bool touches_neighbour() const;
  void stop_at_surface();
  void move_to_first();
  void begin_contact(const BlobView& view);
  void slide(const BlobView& view, Vec3 probe, const Friction& friction);
  [[nodiscard]] Vec3 next_slip(const Pull& pull, float excess, float step, bool& last) const;
  void end_slip(float distance, float cone);
  void glide_by(Vec3 step);
  [[nodiscard]] bool slip_by(const BlobView& view, Vec3 step, Vec3 probe);
  [[nodiscard]] bool is_free(Vec3 probe) const;
  [[nodiscard]] bool settle(const BlobView& view, float& moved);
  void refer_to(const SurfaceFit& fit, bool was_smooth);
  void make_main(std::uint32_t plane);
  [[nodiscard]] PlaneMove move_of(Vec3 probe);
  [[nodiscard]] Pull pull_of(const BlobView& view, Vec3 probe);
  [[nodiscard]] Footing footing() const;
  [[nodiscard]] bool takes_back(const BlobView& view, Vec3 slip, Vec3 probe, const Footing& before,
                                bool was_settled);
  void restore(const Footing& footing);
  void release();
  void lose_face(const SurfaceFit& fit);
  void lose_support();

  // Large members last: the offsets of the others fit into the immediate of a load or store.
  Vec3 position_{};
  Vec3 reference_{};           // normal of the last fit, on the side of the points' normals
  NearFaces near_{};           // other faces around the last fit
  ConstraintPlanes planes_{};  // in contact: faces that hold the proxy, relative to position_; the
                               // main face, that of reference_, is the first
  Vec3 common_normal_{};       // valid where several faces hold the proxy
  float side_ = 1.0F;          // +1 or -1: the probe's side of the surface
  float strength_ = 0.0F;
  const Neighbour* neighbour_ = nullptr;  // set during update() only
  Neighbour found_{};                     // beside a neighbour: the faces of the last fit
  std::uint32_t foreign_ = 0;             // bit i: plane i belongs to a neighbour
  std::uint32_t active_ = 0;              // bit i: plane i holds the probe; valid if count > 1
  float weight_ = 0.0F;                   // of the last fit beside a neighbour
  float stride_ = 1.0F;  // factor of the next step: < 1 after one that led away from the probe
  Vec3 next_{};  // position of the next fit, if has_next_: it waits for candidates or is repeated
  TickBudget budget_;
  State state_ = State::kUntracked;
  bool has_next_ = false;
  bool was_free_ = false;   // not tracking: the step to next_ begins in free space
  bool unsettled_ = false;  // in contact: position_ needs another fit
  bool inside_ = false;     // never in contact
  bool asks_ = false;       // tracking, behind a surface: look_behind() is pending
  bool lost_contact_ = false;
  bool must_hide_ = false;  // hide_points() is pending
  bool blocked_ = false;    // the leading proxy is behind this surface
  bool gives_way_ = false;  // in contact: the neighbour's faces alone hold the probe
  CandidateSets candidates_;
};

}  // namespace tactree::core
