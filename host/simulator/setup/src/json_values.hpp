#pragma once
// Values of JSON files that users write. Every error names place, cause and hint.

#include <Eigen/Core>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tactree/simulation/placement.hpp"

namespace tactree::setup {

// `place` is the place of the value in the file. All functions throw UserError.

[[nodiscard]] nlohmann::json parse_file(const std::filesystem::path& file);

void require_keys(const nlohmann::json& object, const std::string& place,
                  std::initializer_list<const char*> known);

[[nodiscard]] double number(const nlohmann::json& value, const std::string& place);
[[nodiscard]] std::vector<double> numbers(const nlohmann::json& value, const std::string& place,
                                          std::size_t count);
/// Of three numbers; zero if the key is missing.
[[nodiscard]] Eigen::Vector3d vector(const nlohmann::json& object, const char* key,
                                     const std::string& place);
/// Of a 4x4 matrix, row by row.
[[nodiscard]] Eigen::Isometry3d pose(const nlohmann::json& value, const std::string& place);

}  // namespace tactree::setup
