#include <sys/stat.h>

#include <cstdlib>

#include "mesh_import/wire.hpp"
#include "test_files.hpp"

namespace tactree::builder {
namespace {

using namespace std::string_literals;
using Colour = std::array<std::uint8_t, 3>;
using Triangle = std::array<std::uint32_t, 3>;

constexpr const char* kVariable = "TACTREE_IMPORT_MESH";

/// A GLB of points at (i % 1000, i / 1000 % 1000, 0) with the triangles 0 1 2 and 2 1 1000.
std::string glb(std::uint32_t points, const std::string& node, bool normals = false) {
  std::string binary;
  for (std::uint32_t i = 0; i < points; ++i) {
    binary += bytes_of(static_cast<float>(i % 1000)) +
              bytes_of(static_cast<float>(i / 1000 % 1000)) + bytes_of(0.0F);
  }
  const std::size_t positions = binary.size();
  for (std::uint32_t i = 0; normals && i < points; ++i) {
    binary += bytes_of(0.6F) + bytes_of(0.0F) + bytes_of(0.8F);
  }
  const std::size_t normals_end = binary.size();
  for (const std::uint32_t index : {0U, 1U, 2U, 2U, 1U, points > 1000 ? 1000U : 3U}) {
    binary += bytes_of(index);
  }
  const std::string n = std::to_string(points);
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + node +
      R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0)" +
      (normals ? R"(,"NORMAL":2)" : "") + R"(},"indices":1}]}],"buffers":[{"byteLength":)" +
      std::to_string(binary.size()) + R"(}],"bufferViews":[{"buffer":0,"byteLength":)" +
      std::to_string(positions) + R"(},{"buffer":0,"byteOffset":)" + std::to_string(normals_end) +
      R"(,"byteLength":24},{"buffer":0,"byteOffset":)" + std::to_string(positions) +
      R"(,"byteLength":)" + std::to_string(std::max<std::size_t>(normals_end - positions, 1)) +
      R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" + n +
      R"(,"type":"VEC3","min":[0,0,0],"max":[999,999,0]},)" +
      R"({"bufferView":1,"componentType":5125,"count":6,"type":"SCALAR"})" +
      (normals ? R"(,{"bufferView":2,"componentType":5126,"count":)" + n + R"(,"type":"VEC3"})"
               : "") +
      "]}";
  while (json.size() % 4 != 0) json += ' ';
  const auto u32 = [](std::size_t value) { return bytes_of(static_cast<std::uint32_t>(value)); };
  return "glTF" + u32(2) + u32(12 + 8 + json.size() + 8 + binary.size()) + u32(json.size()) +
         "JSON" + json + u32(binary.size()) + std::string("BIN\0", 4) + binary;
}

constexpr const char* kDae =
    R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">
<node id="n"><translate>0 0 7</translate><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";

class ImportTest : public TestFiles {
 protected:
  void TearDown() override { ::unsetenv(kVariable); }

  /// Replaces the import program by a shell script.
  void replace_importer(const std::string& script) {
    const auto path = write("importer.sh", "#!/bin/sh\n" + script + "\n");
    ::chmod(path.c_str(), 0700);
    ::setenv(kVariable, path.c_str(), 1);
  }
  void importer_answers(const std::string& bytes) {
    const auto path = write("answer", bytes);
    replace_importer("exec cat '" + path.string() + "'");
  }
  std::filesystem::path model() { return write("model.glb", glb(4, R"({"mesh":0})")); }
};

std::string wire_header(std::uint64_t points, std::uint64_t triangles, std::uint32_t flags = 0) {
  WireHeader header;
  header.points = points;
  header.triangles = triangles;
  header.flags = flags;
  return bytes_of(header);
}

std::string wire_point(double x, double y, double z) {
  return bytes_of(x) + bytes_of(y) + bytes_of(z);
}

std::string wire_end() { return {kWireEnd.begin(), kWireEnd.end()}; }

TEST_F(ImportTest, ReadsGltfBinary) {
  const Scan scan = read(glb(4, R"({"mesh":0})", true), "anything.txt");
  EXPECT_EQ(scan.format, "glTF binary (GLB)");
  ASSERT_EQ(scan.positions.size(), 4U);
  EXPECT_EQ(scan.positions[3], Eigen::Vector3d(3, 0, 0));
  ASSERT_EQ(scan.triangles.size(), 2U);
  EXPECT_EQ(scan.triangles[0], (Triangle{0, 1, 2}));
  ASSERT_EQ(scan.normals.size(), 4U);
  EXPECT_NEAR(scan.normals[0].x(), 0.6, 1e-6);
}

TEST_F(ImportTest, AppliesNodeTransforms) {
  const Scan scan = read(glb(4, R"({"mesh":0,"translation":[10,20,30],"scale":[-2,2,2]})", true));
  ASSERT_EQ(scan.positions.size(), 4U);
  EXPECT_EQ(scan.positions[1], Eigen::Vector3d(8, 20, 30));
  // A reflection reverses the winding; the importer restores it.
  EXPECT_EQ(scan.triangles.at(0), (Triangle{0, 2, 1}));
  EXPECT_NEAR(scan.normals.at(0).x(), -0.6, 1e-6);
  EXPECT_NEAR(scan.normals.at(0).z(), 0.8, 1e-6);
}

TEST_F(ImportTest, ReadsCollada) {
  const Scan scan = read(kDae, "model.ply");
  EXPECT_EQ(scan.format, "COLLADA");
  ASSERT_EQ(scan.positions.size(), 3U);
  EXPECT_EQ(scan.positions[1], Eigen::Vector3d(1, 0, 7));
  EXPECT_EQ(scan.triangles.size(), 1U);
}

TEST_F(ImportTest, ReadsFormatOrFileUnit) {
  EXPECT_EQ(read(glb(4, R"({"mesh":0})")).unit_m, 1.0);
  std::string inches = kDae;
  EXPECT_EQ(read(inches).unit_m, 1.0);
  inches.replace(inches.find("<up_axis>"), 0, R"(<unit name="inch" meter="0.0254"/>)");
  const Scan scan = read(inches);
  EXPECT_EQ(scan.unit_m, 0.0254);
  EXPECT_NEAR(scan.positions.at(1).x(), 1.0, 1e-6);  // positions stay in units of the file
  EXPECT_NEAR(scan.positions.at(1).z(), 7.0, 1e-6);
  EXPECT_FALSE(read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unit_m.has_value());
}

/// The axes are those of the file, in which z is up.
TEST_F(ImportTest, KeepsAxesOf3ds) {
  const auto chunk = [](std::uint16_t id, const std::string& content) {
    return bytes_of(id) + bytes_of(static_cast<std::uint32_t>(6 + content.size())) + content;
  };
  std::string points = bytes_of(std::uint16_t{3});
  for (const Corner& corner : {Corner{1, 2, 3}, Corner{4, 2, 3}, Corner{1, 5, 7}}) {
    points += bytes_of(corner);
  }
  const std::string faces = bytes_of(std::array<std::uint16_t, 5>{1, 0, 1, 2, 7});
  const std::string object = "a\0"s + chunk(0x4100, chunk(0x4110, points) + chunk(0x4120, faces));
  const Scan scan = read(chunk(
      0x4d4d, chunk(0x0002, bytes_of(std::uint32_t{3})) + chunk(0x3d3d, chunk(0x4000, object))));
  EXPECT_EQ(scan.format, "3DS");
  ASSERT_EQ(scan.positions.size(), 3U);
  EXPECT_LT((scan.positions[0] - Eigen::Vector3d(1, 2, 3)).norm(), 1e-6);
  EXPECT_LT((scan.positions[2] - Eigen::Vector3d(1, 5, 7)).norm(), 1e-6);
}

TEST_F(ImportTest, ReadsGltfWithExternalBuffer) {
  write("points.bin", bytes_of(std::array<float, 9>{0, 0, 0, 1, 0, 0, 0, 1, 0}));
  const std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
      "buffers":[{"byteLength":36,"uri":"URI"}],"bufferViews":[{"buffer":0,"byteLength":36}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
      "min":[0,0,0],"max":[1,1,0]}]})";
  std::string beside = json;
  beside.replace(beside.find("URI"), 3, "points.bin");
  EXPECT_EQ(read(beside, "model").triangles.size(), 1U);
  // Files in other folders are refused.
  std::filesystem::create_directory(folder_ / "inner");
  std::string above = json;
  above.replace(above.find("URI"), 3, "../points.bin");
  expect_parts(refusal_of(above, "inner/model.gltf"), "inner/model.gltf", "cannot be read");
}

TEST_F(ImportTest, RefusesDamagedMesh) {
  const std::string whole = glb(4, R"({"mesh":0})");
  for (const std::size_t length : {std::size_t{13}, std::size_t{60}, whole.size() - 100}) {
    const std::string message = refusal_of(whole.substr(0, length), "cut.glb");
    expect_parts(message, "cut.glb", "glTF");
    EXPECT_EQ(message.find("model-by-content"), std::string::npos) << message;
  }
}

TEST_F(ImportTest, RefusesMeshWithoutPoints) {
  expect_parts(refusal_of(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[]}]})"),
               "cannot be read");
}

#ifndef TACTREE_SANITIZED  // AddressSanitizer needs all addresses
TEST_F(ImportTest, MemoryLimitHolds) {
  ReadOptions options;
  options.child_memory_bytes = 160ULL << 20;
  const auto path = write("large.glb", glb(4'000'000, R"({"mesh":0})"));
  expect_parts(refusal(path, options), "large.glb", "memory limit");
}
#endif

TEST_F(ImportTest, ReportsCrash) {
  replace_importer("kill -SEGV $$");
  expect_parts(refusal(model()), "model.glb", "crashed (signal 11");
}

TEST_F(ImportTest, ReportsEarlyEnd) {
  replace_importer("exit 7");
  expect_parts(refusal(model()), "model.glb", "exit code 7");
}

TEST_F(ImportTest, StopsSlowImporter) {
  replace_importer("exec sleep 600");
  ReadOptions options;
  options.child_seconds = 0.0;  // over at once, whatever the machine does
  expect_parts(refusal(model(), options), "model.glb", "took more than 0 seconds");
}

TEST_F(ImportTest, PassesOnImporterRefusal) {
  WireHeader header;
  header.status = static_cast<std::uint32_t>(WireStatus::kRefused);
  header.text_bytes = 11;
  importer_answers(bytes_of(header) + "no\nwheels\t!");
  expect_parts(refusal(model()), "no wheels !");
  header.status = static_cast<std::uint32_t>(WireStatus::kOutOfMemory);
  header.text_bytes = 0;
  importer_answers(bytes_of(header));
  expect_parts(refusal(model()), "memory limit");
}

TEST_F(ImportTest, ReadsValidAnswer) {
  const std::string normal = bytes_of(std::array<float, 3>{0, 0, 1});
  std::string answer = wire_header(3, 1, kHasNormals | kHasColours);
  for (int i = 0; i < 3; ++i) answer += wire_point(i, i * i, 1) + normal + "\x01\x02\x03";
  importer_answers(answer + bytes_of(Triangle{2, 1, 0}) + wire_end());
  const Scan scan = read_scan(model());
  EXPECT_EQ(scan.positions.at(2), Eigen::Vector3d(2, 4, 1));
  EXPECT_EQ(scan.normals.at(2), Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(scan.colours.at(0), (Colour{1, 2, 3}));
  EXPECT_EQ(scan.triangles.at(0), (Triangle{2, 1, 0}));
}

TEST_F(ImportTest, RefusesInvalidAnswers) {
  const std::string three = wire_point(0, 0, 0) + wire_point(1, 0, 0) + wire_point(0, 1, 0);
  importer_answers(std::string(100, 'x'));
  expect_parts(refusal(model()), "is not valid");
  std::string other_magic = wire_header(3, 0) + three + wire_end();
  other_magic[7] = '1';
  importer_answers(other_magic);
  expect_parts(refusal(model()), "is not valid");
  importer_answers(wire_header(1ULL << 60, 0) + three);
  expect_parts(refusal(model()), "ended before its result was complete");
  importer_answers(wire_header(3, 1ULL << 60) + three);
  expect_parts(refusal(model()), "ended before its result was complete");
  importer_answers(wire_header(3, 0) + three + "TACENDxx");
  expect_parts(refusal(model()), "is not valid");
  importer_answers(wire_header(3, 1) + three + bytes_of(Triangle{0, 1, 3}) + wire_end());
  expect_parts(refusal(model()), "none of the 1 faces");
  importer_answers(wire_header(0, 0) + wire_end());
  expect_parts(refusal(model()), "contains no points");
  WireHeader long_text;
  long_text.text_bytes = 0xffff'ffff;
  importer_answers(bytes_of(long_text));
  expect_parts(refusal(model()), "is not valid");
}

TEST_F(ImportTest, DropsNonFiniteAnswers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  importer_answers(wire_header(4, 2) + wire_point(0, 0, 0) + wire_point(nan, 0, 0) +
                   wire_point(0, 1, 0) + wire_point(1, 1, 0) + bytes_of(Triangle{0, 1, 2}) +
                   bytes_of(Triangle{0, 2, 3}) + wire_end());
  const Scan scan = read_scan(model());
  EXPECT_EQ(scan.positions.size(), 3U);
  EXPECT_EQ(dropped(scan, "non_finite"), 1U);
  EXPECT_EQ(dropped(scan, "face_non_finite"), 1U);
  EXPECT_EQ(scan.triangles.at(0), (Triangle{0, 1, 2}));
}

TEST_F(ImportTest, MemoryLimitStopsEndlessAnswer) {
  const auto head = write("head", wire_header(1ULL << 40, 0));
  replace_importer("cat '" + head.string() + "'; exec cat /dev/zero");
  ReadOptions options;
  options.scan_memory_bytes = 1 << 20;
  expect_parts(refusal(model(), options), "too large");
}

TEST_F(ImportTest, ReportsMissingProgram) {
  ::setenv(kVariable, (folder_ / "absent").c_str(), 1);
  expect_parts(refusal(model()), "model.glb", kVariable, "absent");
}

}  // namespace
}  // namespace tactree::builder
