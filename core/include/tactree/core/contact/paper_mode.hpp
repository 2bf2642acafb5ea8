#pragma once
// The method of El-Far, Georganas and El Saddik, "Collision Detection and Force Response in
// Highly-Detailed Point-Based Hapto-Visual Virtual Environments", section 3. Implemented as
// published, including its missed collisions; docs/DESIGN.md explains why it is not the default.
//
// Interrupt safety: pure functions.

#include "tactree/core/model/blob.hpp"
#include "tactree/core/model/nearest.hpp"

namespace tactree::core {

struct PaperContact {
  bool in_contact = false;
  Leaf leaf{};  ///< the leaf with the collision
};

/// Collision detection: the probe lies in the axis-aligned box (edge a) of a point of its own leaf,
/// or of a leaf that holds one of the six points probe +- s on each axis (the six-point rule).
/// A probe that coincides with a point lies in its box. Cost: 7 descents, 7 leaves.
[[nodiscard]] PaperContact paper_collision(const BlobView& view, Vec3 probe);

/// Force response: the point nearest to the probe among those of the collision leaf and of the
/// neighbours that the six-point rule reaches from it. Precondition: contact.in_contact.
/// Uses the neighbour table if the blob has one. Cost: 7 leaves.
[[nodiscard]] NearestPoint paper_nearest(const BlobView& view, Vec3 probe,
                                         const PaperContact& contact);

}  // namespace tactree::core
