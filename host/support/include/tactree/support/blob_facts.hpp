#pragma once
// Contents, guarantees and sizes of a blob, as values for people and programs.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "tactree/core/model/blob.hpp"

namespace tactree::support {

/// "surface" or "paper".
[[nodiscard]] const char* profile_name(const core::BlobHeader& header);

/// Converts to the double of the shortest decimal representation: 0.0005, not 0.00050000002.
[[nodiscard]] double shortest_double(float value);

[[nodiscard]] double bytes_per_point(const core::BlobHeader& header);

/// Number of points per material. Empty if the blob has no materials.
[[nodiscard]] std::vector<std::uint32_t> points_of_materials(const core::BlobView& view);

/// Bytes of the flags that state where the material is; part of the header's bytes.
[[nodiscard]] std::uint32_t interior_bytes(const core::BlobView& view);

/// Fraction of the points with material behind them.
[[nodiscard]] double backed_share(const core::BlobView& view);

/// All facts, by the names of `tactree info --json`.
[[nodiscard]] nlohmann::json blob_facts(const core::BlobView& view);

}  // namespace tactree::support
