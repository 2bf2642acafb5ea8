// Builds the blob of a sphere, queries its nearest point, and saves it to the file argv[1].
#include <cmath>
#include <cstdio>
#include <fstream>

#include "tactree/builder/model.hpp"
#include "tactree/core/model/nearest.hpp"
#include "tactree/simulation/hand_script.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    return 2;
  }
  tactree::builder::Model model;
  constexpr int kPoints = 2000;
  constexpr double kRadius = 0.02;
  for (int i = 0; i < kPoints; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kPoints;
    const double ring = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d normal(ring * std::cos(2.4 * i), ring * std::sin(2.4 * i), z);
    model.positions.push_back(kRadius * normal);
    model.normals.push_back(normal.cast<float>());
  }
  model.spacing_m = 0.0016;
  model.support_radius_m = 0.004;
  model.reach_m = 0.005;
  const tactree::builder::WrittenBlob blob = tactree::builder::write_blob(model);

  tactree::core::BlobView view;
  if (open_blob(blob.bytes, view) != tactree::core::BlobStatus::kOk) {
    return 1;
  }
  const Eigen::Vector3f probe = 1.05F * model.positions.front().cast<float>();  // 1 mm above
  const auto nearest = nearest_within(view, {probe.x(), probe.y(), probe.z()}, 0.005F);
  const double distance = std::sqrt(static_cast<double>(nearest.distance_squared));
  std::printf("%u points, nearest %u at %.6f m\n", view.point_count(), nearest.index, distance);

  std::ofstream out(argv[1], std::ios::binary);
  out.write(reinterpret_cast<const char*>(blob.bytes.data()),
            static_cast<std::streamsize>(blob.bytes.size()));
  const bool scripted = !tactree::simulation::script_names().empty();
  return nearest.found() && std::abs(distance - 0.001) < 1e-5 && scripted && out.flush() ? 0 : 1;
}
