// The force law: spring, damping, texture and friction at the proxy; paper mode.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/contact/renderer.hpp"

#include "tactree/core/contact/paper_mode.hpp"

namespace tactree::core {
namespace {

/// The damping force, at most as large as the spring force, so that contact begins and ends without
/// a step.
Vec3 damping(float damping_Ns_m, Vec3 velocity, Vec3 spring) {
  const Vec3 wanted = damping_Ns_m * velocity;
  const float size = length(wanted);
  const float allowed = length(spring);
  return size > allowed ? (allowed / size) * wanted : wanted;
}

/// Factor by which the texture reduces the force, friction included; 0 where the probe is above the
/// cut surface.
float share_of(float penetration_m, float texture_depth_m) {
  if (!(texture_depth_m > 0.0F)) {
    return 1.0F;
  }
  return penetration_m > texture_depth_m ? 1.0F - texture_depth_m / penetration_m : 0.0F;
}

/// Energy of a spring whose force the safety gate limits, J.
float spring_energy(float stiffness_N_m, float length_m, float force_max_N) {
  const float force = stiffness_N_m * length_m;
  if (!(force > force_max_N)) {
    return 0.5F * force * length_m;
  }
  return force_max_N * (length_m - 0.5F * force_max_N / stiffness_N_m);
}

}  // namespace

// Neither this nor render_proxy() is inlined: their stack frames would add to the deepest call
// chain.
[[gnu::noinline]] Rendering Renderer::render_paper(const BlobView& view, const Configuration& c,
                                                   Vec3 probe) {
  Rendering r;
  r.proxy = probe;
  const PaperContact contact = paper_collision(view, probe);
  if (!contact.in_contact) {
    return r;
  }
  const NearestPoint nearest = paper_nearest(view, probe, contact);
  if (!nearest.found()) {
    return r;
  }
  const Vec3 displacement = nearest.position - probe;
  r.in_contact = true;
  r.proxy = nearest.position;
  r.normal = normalized_or(displacement, {});
  const float stiffness_N_m =
      contact_parameters_of(view, c, material_at(view, c, nearest.index)).stiffness_N_m;
  r.force = stiffness_N_m * displacement;
  r.strength = 1.0F;
  r.penetration_m = length(displacement);
  r.stored_energy = spring_energy(stiffness_N_m, r.penetration_m, c.limits.force_max_N);
  return r;
}

Rendering Renderer::render_proxy(const BlobView& view, const Configuration& c, Vec3 probe,
                                 Vec3 velocity) {
  Rendering r;
  r.proxy = proxy_.position();
  r.complete = proxy_.complete();
  r.inside = proxy_.inside();
  if (!proxy_.in_contact()) {
    return r;
  }
  const Vec3 normal = proxy_.normal();
  const Vec3 displacement = r.proxy - probe;
  if (!proxy_.is_waiting()) {
    blend_materials(view, c, proxy_.candidates(), r.proxy, proxy_.stored_normal(), materials_);
  }
  const ContactParameters parameters = contact_parameters_of(view, c, materials_);
  friction_ = {parameters.static_friction, parameters.dynamic_friction};
  r.penetration_m = dot(displacement, normal);
  const float share =
      share_of(r.penetration_m, texture_depth(view, c, materials_, r.proxy, normal));
  const Vec3 spring = (share * parameters.stiffness_N_m) * displacement;
  const Vec3 force = spring - damping(parameters.damping_Ns_m, velocity, spring);
  // Damping may cancel the push, but never pulls the hand into the object.
  const float push = dot(force, normal);
  const Vec3 repelling = push < 0.0F ? force - push * normal : force;
  r.in_contact = true;
  r.slipping = proxy_.slipping();
  r.normal = normal;
  r.strength = proxy_.strength();
  r.force = r.strength * repelling;
  r.stored_energy = r.strength * spring_energy(parameters.stiffness_N_m,
                                               share * length(displacement), c.limits.force_max_N);
  return r;
}

}  // namespace tactree::core
