#pragma once
// Share of the points of a build whose normal points to the wrong side.

#include "known_bodies.hpp"
#include "tactree/builder/build_model.hpp"

namespace tactree::bench {

/// Metres per spacing of a KnownCloud.
inline constexpr double kUnit_m = 1e-3;

/// The cloud as a scan in metres, without normals.
[[nodiscard]] builder::Scan scan_of(const KnownCloud& cloud);

/// Compares the normals in the blob with the true ones of the nearest points of the cloud.
[[nodiscard]] double wrong_share(const KnownCloud& cloud, const builder::BuildResult& built);

}  // namespace tactree::bench
