// glTF 2: quantized positions, skins, morph targets, sparse accessors, required extensions.

#include <meshoptimizer.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "mesh_writers.hpp"
#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Json = nlohmann::json;
using test::GltfWriter;
using Triangle = std::array<std::uint32_t, 3>;

constexpr int kByte = 5120;
constexpr int kUByte = 5121;
constexpr int kShort = 5122;
constexpr int kUShort = 5123;
constexpr int kUInt = 5125;
constexpr int kFloat = 5126;

const std::vector<std::uint16_t> kFaces = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};

/// A tetrahedron with positions of any type.
template <typename Number>
GltfWriter tetrahedron(const std::vector<Number>& positions, int component,
                       std::size_t stride = 0) {
  GltfWriter gltf;
  const std::size_t at = gltf.add(positions, component, "VEC3", 3, stride);
  const std::size_t faces = gltf.add(kFaces, kUShort, "SCALAR", 1);
  gltf.root["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", at}}},
                                             {"indices", faces}};
  return gltf;
}

GltfWriter floats() {
  return tetrahedron(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, kFloat);
}

Json& attributes(GltfWriter& gltf) { return gltf.root["meshes"][0]["primitives"][0]["attributes"]; }

class GltfTest : public TestFiles {
 protected:
  void expect_point(const Scan& scan, std::size_t at, double x, double y, double z) {
    ASSERT_GT(scan.positions.size(), at);
    const Eigen::Vector3d off = scan.positions[at] - Eigen::Vector3d(x, y, z);
    EXPECT_LT(off.norm(), 1e-6) << at << ": " << scan.positions[at].transpose();
  }
};

TEST_F(GltfTest, LeavesOutHiddenNodes) {
  GltfWriter gltf = floats();
  gltf.root["scenes"][0]["nodes"] = {0, 1};
  gltf.root["nodes"][1] = {{"mesh", 0}, {"children", {2}}};
  gltf.root["nodes"][2] = {{"mesh", 0}};
  Json& visible = gltf.root["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"];
  visible = true;
  EXPECT_EQ(read(gltf.glb()).positions.size(), 12U);
  visible = false;
  gltf.root["extensionsRequired"] = {"KHR_node_visibility"};
  const Scan scan = read(gltf.glb());
  EXPECT_EQ(scan.positions.size(), 4U);
  expect_parts(scan.warnings.at(0), "1 hidden nodes", "left out");
}

TEST_F(GltfTest, PlacesInstances) {
  GltfWriter gltf = floats();
  const std::size_t shifts = gltf.add(std::vector<float>{1, 2, 3, 0, 0, 0}, kFloat, "VEC3", 3);
  // None, and a quarter turn about z. As bytes, 90 and 127 / 127 are rounded.
  const std::size_t turns =
      gltf.add(std::vector<float>{0, 0, 0, 1, 0, 0, 0.70710678F, 0.70710678F}, kFloat, "VEC4", 4);
  const std::size_t turns_in_bytes =
      gltf.add(std::vector<std::int8_t>{0, 0, 0, 127, 0, 0, 90, 90}, kByte, "VEC4", 4);
  gltf.root["accessors"][turns_in_bytes]["normalized"] = true;
  const std::size_t scales = gltf.add(std::vector<float>{1, 1, 1, 2, 1, -1}, kFloat, "VEC3", 3);
  gltf.root["nodes"][0]["translation"] = {10, 0, 0};
  gltf.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  Json& placed = gltf.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  placed = {{"TRANSLATION", shifts}, {"ROTATION", turns}, {"SCALE", scales}};
  for (const std::size_t rotation : {turns, turns_in_bytes}) {
    placed["ROTATION"] = rotation;
    const Scan scan = read(gltf.glb());
    EXPECT_TRUE(scan.warnings.empty());
    ASSERT_EQ(scan.positions.size(), 8U);
    expect_point(scan, 1, 12, 2, 3);
    expect_point(scan, 5, 10, 2, 0);  // scaled, then turned
    expect_point(scan, 7, 10, 0, -1);
    // The faces of the reflected instance are turned over.
    ASSERT_EQ(scan.triangles.size(), 8U);
    EXPECT_EQ(scan.triangles[0], (Triangle{0, 1, 2}));
    EXPECT_EQ(scan.triangles[4], (Triangle{4, 6, 5}));
  }
  placed = {{"_NUMBER", scales}};
  EXPECT_EQ(read(gltf.glb()).positions.size(), 4U);
  placed = {{"TRANSLATION", shifts}, {"SCALE", 0}};
  expect_parts(refusal_of(gltf.glb()), "do not have one entry per instance");
  placed = {{"TRANSLATION", 99}};
  expect_parts(refusal_of(gltf.glb()), "entry 99 of \"accessors\"");
}

TEST_F(GltfTest, ReadsIntegerPositions) {
  const std::vector<std::uint16_t> words = {0, 0, 0, 16383, 0, 0, 0, 10922, 0, 0, 0, 65535};
  GltfWriter gltf = tetrahedron(words, kUShort, 8);
  gltf.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  gltf.root["nodes"][0]["scale"] = {0.001, 0.001, 0.001};
  gltf.root["nodes"][0]["translation"] = {1, 2, 3};
  const Scan scan = read(gltf.glb());
  EXPECT_EQ(scan.triangles.size(), 4U);
  expect_point(scan, 1, 17.383, 2, 3);
  expect_point(scan, 3, 1, 2, 68.535);
  gltf.root["accessors"][0]["normalized"] = true;
  expect_point(read(gltf.glb()), 3, 1, 2, 3.001);
  GltfWriter bytes =
      tetrahedron(std::vector<std::int8_t>{0, 0, 0, -128, 0, 0, 0, 127, 0, 0, 0, 64}, kByte, 4);
  expect_point(read(bytes.glb()), 1, -128, 0, 0);
  bytes.root["accessors"][0]["normalized"] = true;
  const Scan normalized = read(bytes.glb());
  expect_point(normalized, 1, -1, 0, 0);
  expect_point(normalized, 2, 0, 1, 0);
  GltfWriter shorts =
      tetrahedron(std::vector<std::int16_t>{0, 0, 0, -7, 0, 0, 0, 9, 0, 0, 0, 11}, kShort, 8);
  expect_point(read(shorts.glb()), 1, -7, 0, 0);
}

/// Two joints below an armature of another scale; the last point hangs on both.
GltfWriter skinned() {
  GltfWriter gltf = floats();
  const std::size_t joints = gltf.add(
      std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0}, kUByte, "VEC4", 4);
  const std::size_t weights = gltf.add(
      std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0.5, 0.5, 0, 0}, kFloat, "VEC4", 4);
  // The second joint lies at (10, 0, 0) when the mesh is bound.
  const std::size_t inverse =
      gltf.add(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,   0, 0, 1,
                                  1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -10, 0, 0, 1},
               kFloat, "MAT4", 16);
  attributes(gltf)["JOINTS_0"] = joints;
  attributes(gltf)["WEIGHTS_0"] = weights;
  gltf.root["skins"] = {{{"joints", {2, 3}}, {"inverseBindMatrices", inverse}}};
  gltf.root["nodes"] = {
      {{"mesh", 0}, {"skin", 0}, {"translation", {500, 0, 0}}, {"scale", {3, 3, 3}}},
      {{"scale", {0.01, 0.01, 0.01}}, {"children", {2}}},
      {{"children", {3}}},
      {{"translation", {10, 0, 100}}}};
  gltf.root["scenes"][0]["nodes"] = {0, 1};
  return gltf;
}

TEST_F(GltfTest, JointsPlaceSkinPoints) {
  const Scan scan = read(skinned().glb());
  ASSERT_EQ(scan.positions.size(), 4U);
  expect_point(scan, 0, 0, 0, 0);
  expect_point(scan, 1, 0.01, 0, 1);
  expect_point(scan, 2, 0, 0.01, 0);  // weights of another sum
  expect_point(scan, 3, 0, 0, 0.51);  // half of each joint
  EXPECT_TRUE(scan.warnings.empty());
}

TEST_F(GltfTest, RefusesInvalidSkins) {
  GltfWriter gltf = skinned();
  gltf.root["skins"][0]["joints"] = {2};
  expect_parts(refusal_of(gltf.glb(), "a.glb"), "a.glb", "a joint that its skin does not have");
  gltf = skinned();
  gltf.root["skins"][0]["joints"] = {2, 3, 2};
  expect_parts(refusal_of(gltf.glb()), "more joints than inverseBindMatrices");
  gltf = skinned();
  gltf.root["skins"][0]["joints"] = {2, 99};
  expect_parts(refusal_of(gltf.glb()), "a joint of a skin is not one of its nodes");
  gltf = skinned();
  gltf.root["accessors"][3]["count"] = 3;
  expect_parts(refusal_of(gltf.glb()), "different numbers of weights and points");
}

TEST_F(GltfTest, AppliesStoredMorphWeights) {
  GltfWriter gltf = floats();
  const std::size_t target =
      gltf.add(std::vector<float>{0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0}, kFloat, "VEC3", 3);
  gltf.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", target}}};
  expect_point(read(gltf.glb()), 1, 1, 0, 0);
  gltf.root["meshes"][0]["weights"] = {0.5};
  expect_point(read(gltf.glb()), 1, 3, 0, 0);
  gltf.root["nodes"][0]["weights"] = {1.0};
  expect_point(read(gltf.glb()), 1, 5, 0, 0);
}

TEST_F(GltfTest, ReadsSparseAccessorsAndStrips) {
  GltfWriter gltf = floats();
  const std::size_t where = gltf.add(std::vector<std::uint16_t>{3}, kUShort, "SCALAR", 1);
  const std::size_t what = gltf.add(std::vector<float>{0, 0, 9}, kFloat, "VEC3", 3);
  gltf.root["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", where}, {"componentType", kUShort}}},
      {"values", {{"bufferView", what}}}};
  expect_point(read(gltf.glb()), 3, 0, 0, 9);
  gltf.root["accessors"][0]["sparse"]["count"] = 7;
  expect_parts(refusal_of(gltf.glb()), "accessor 0 ends after");
  gltf = floats();
  const std::size_t strip = gltf.add(std::vector<std::uint8_t>{0, 1, 2, 3}, kUByte, "SCALAR", 1);
  gltf.root["meshes"][0]["primitives"][0]["indices"] = strip;
  gltf.root["meshes"][0]["primitives"][0]["mode"] = 5;
  EXPECT_EQ(read(gltf.glb()).triangles,
            (std::vector<Triangle>{Triangle{0, 1, 2}, Triangle{2, 1, 3}}));
  gltf.root["meshes"][0]["primitives"][0]["mode"] = 6;
  EXPECT_EQ(read(gltf.glb()).triangles,
            (std::vector<Triangle>{Triangle{0, 1, 2}, Triangle{0, 2, 3}}));
  gltf.root["meshes"][0]["primitives"][0]["mode"] = 0;
  EXPECT_TRUE(read(gltf.glb()).triangles.empty());
}

TEST_F(GltfTest, ReadsColoursOfAllTypes) {
  GltfWriter gltf = floats();
  attributes(gltf)["COLOR_0"] =
      gltf.add(std::vector<std::uint8_t>{255, 0, 51, 7, 0, 0, 0, 7, 0, 0, 0, 7, 0, 0, 0, 7}, kUByte,
               "VEC4", 4);
  gltf.root["accessors"].back()["normalized"] = true;
  EXPECT_EQ(read(gltf.glb()).colours.at(0), (std::array<std::uint8_t, 3>{255, 0, 51}));
  attributes(gltf)["COLOR_0"] =
      gltf.add(std::vector<float>{1, 0.5, 0, 0, 0, 0, 0, 0, 0, 2, -1, 0}, kFloat, "VEC3", 3);
  const Scan scan = read(gltf.glb());
  EXPECT_EQ(scan.colours.at(0), (std::array<std::uint8_t, 3>{255, 128, 0}));
  EXPECT_EQ(scan.colours.at(3), (std::array<std::uint8_t, 3>{255, 0, 0}));
}

TEST_F(GltfTest, NamesUnknownRequiredExtensions) {
  GltfWriter gltf = floats();
  gltf.root["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_transform"};
  EXPECT_EQ(read(gltf.glb()).positions.size(), 4U);
  gltf.root["extensionsRequired"] = {"KHR_materials_unlit", "ACME_shape"};
  expect_parts(refusal_of(gltf.glb(), "a.glb"), "a.glb", "requires the extension ACME_shape",
               "save it as PLY");
  gltf.root["extensionsRequired"] = {"ACME_compression"};
  expect_parts(refusal_of(gltf.glb()), "compressed with ACME_compression");
  // The library decodes Draco, and would place its skins wrong.
  GltfWriter draco = skinned();
  draco.root["meshes"][0]["primitives"][0]["extensions"] = {
      {"KHR_draco_mesh_compression", Json::object()}};
  draco.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  expect_parts(refusal_of(draco.glb()), "a skin and data compressed with KHR_draco");
  draco.root["nodes"][0].erase("skin");
  draco.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = Json::object();
  expect_parts(refusal_of(draco.glb()), "instances (EXT_mesh_gpu_instancing) and data compressed");
  draco.root["extensionsRequired"] = {"KHR_draco_mesh_compression", "ACME_shape"};
  expect_parts(refusal_of(draco.glb()), "requires the extension ACME_shape");
}

/// The words or bytes of the buffer view of an accessor.
template <typename Word>
std::vector<Word> words_of(const GltfWriter& gltf, std::size_t view) {
  const Json& names = gltf.root["bufferViews"][view];
  const auto bytes = gltf.data.substr(names["byteOffset"], names["byteLength"]);
  std::vector<Word> words(bytes.size() / sizeof(Word));
  std::memcpy(words.data(), bytes.data(), words.size() * sizeof(Word));
  return words;
}

/// Compresses a buffer view as EXT_meshopt_compression states; a buffer without bytes replaces it.
void compress(GltfWriter& gltf, std::size_t view, std::size_t stride, const std::string& mode,
              const std::string& filter = "NONE") {
  const auto bytes = words_of<unsigned char>(gltf, view);
  const std::size_t count = bytes.size() / stride;
  std::array<unsigned char, 4096> packed{};
  std::size_t length = 0;
  if (mode == "ATTRIBUTES") {
    length = meshopt_encodeVertexBuffer(packed.data(), packed.size(), bytes.data(), count, stride);
  } else {
    const auto words = words_of<std::uint16_t>(gltf, view);
    const std::vector<unsigned> indices(words.begin(), words.end());
    length = mode == "TRIANGLES"
                 ? meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), count)
                 : meshopt_encodeIndexSequence(packed.data(), packed.size(), indices.data(), count);
  }
  Json extension = {{"buffer", 0},          {"byteOffset", gltf.data.size()},
                    {"byteLength", length}, {"byteStride", stride},
                    {"mode", mode},         {"count", count}};
  if (filter != "NONE") extension["filter"] = filter;
  gltf.data.append(reinterpret_cast<const char*>(packed.data()), length);
  Json& names = gltf.root["bufferViews"][view];
  names["buffer"] = 1;
  names["byteOffset"] = 0;
  names["extensions"]["EXT_meshopt_compression"] = extension;
  gltf.root["buffers"] = {{{"byteLength", gltf.data.size()}}, {{"byteLength", bytes.size()}}};
  gltf.root["extensionsRequired"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
}

/// Integer positions and the faces, both compressed.
GltfWriter compressed(const std::string& mode = "TRIANGLES") {
  GltfWriter gltf = tetrahedron(
      std::vector<std::uint16_t>{0, 0, 0, 16383, 0, 0, 0, 10922, 0, 0, 0, 65535}, kUShort, 8);
  compress(gltf, 0, 8, "ATTRIBUTES");
  compress(gltf, 1, 2, mode);
  return gltf;
}

Json& extension_of(GltfWriter& gltf, std::size_t view) {
  return gltf.root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"];
}

TEST_F(GltfTest, ReadsMeshoptCompression) {
  for (const char* mode : {"TRIANGLES", "INDICES"}) {
    const Scan scan = read(compressed(mode).glb());
    ASSERT_EQ(scan.triangles.size(), 4U) << mode;
    expect_point(scan, 1, 16383, 0, 0);
    expect_point(scan, 3, 0, 0, 65535);
    for (std::size_t face = 0; face < 4; ++face) {  // the codec may turn a triangle
      Triangle corners = scan.triangles[face];
      Triangle expected = {kFaces[3 * face], kFaces[3 * face + 1], kFaces[3 * face + 2]};
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      std::rotate(expected.begin(), std::min_element(expected.begin(), expected.end()),
                  expected.end());
      EXPECT_EQ(corners, expected) << mode;
    }
  }
}

TEST_F(GltfTest, DecodesFiltersOfMeshopt) {
  const std::vector<float> positions = {0, 0, 0, 1.5, 0, 0, 0, -2.25, 0, 0, 0, 1000};
  std::vector<std::uint32_t> powers(positions.size());
  meshopt_encodeFilterExp(powers.data(), 4, 12, 15, positions.data());
  GltfWriter gltf = tetrahedron(powers, kFloat, 12);
  compress(gltf, 0, 12, "ATTRIBUTES", "EXPONENTIAL");
  const std::vector<float> normals = {0.6F, 0.8F, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0, 0, -1, 0, 0};
  std::vector<std::int8_t> octahedral(16);
  meshopt_encodeFilterOct(octahedral.data(), 4, 4, 8, normals.data());
  std::vector<std::int8_t> stored;  // the reader takes three of four
  for (std::size_t i = 0; i < 16; ++i) {
    if (i % 4 != 3) stored.push_back(octahedral[i]);
  }
  const std::size_t at = gltf.add(stored, kByte, "VEC3", 3, 4);
  gltf.root["accessors"][at]["normalized"] = true;
  attributes(gltf)["NORMAL"] = at;
  compress(gltf, at, 4, "ATTRIBUTES", "OCTAHEDRAL");
  const Scan scan = read(gltf.glb());
  expect_point(scan, 1, 1.5, 0, 0);
  expect_point(scan, 2, 0, -2.25, 0);
  expect_point(scan, 3, 0, 0, 1000);
  ASSERT_EQ(scan.normals.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3f normal(normals[4 * i], normals[4 * i + 1], normals[4 * i + 2]);
    EXPECT_GT(scan.normals[i].normalized().dot(normal), 0.9995F) << i;
  }
}

TEST_F(GltfTest, DecodesTurnsOfInstances) {
  const std::vector<float> turns = {0, 0, 0, 1, 0, 0, 0.70710678F, 0.70710678F};
  std::vector<std::int16_t> packed(turns.size());
  meshopt_encodeFilterQuat(packed.data(), 2, 8, 16, turns.data());
  GltfWriter gltf = floats();
  const std::size_t at = gltf.add(packed, kShort, "VEC4", 4);
  gltf.root["accessors"][at]["normalized"] = true;
  compress(gltf, at, 8, "ATTRIBUTES", "QUATERNION");
  gltf.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["ROTATION"] = at;
  const Scan scan = read(gltf.glb());
  ASSERT_EQ(scan.positions.size(), 8U);
  EXPECT_LT((scan.positions[1] - Eigen::Vector3d::UnitX()).norm(), 1e-4);
  EXPECT_LT((scan.positions[5] - Eigen::Vector3d::UnitY()).norm(), 1e-4);
  const std::size_t view = gltf.root["accessors"][at]["bufferView"];
  gltf.root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]["byteStride"] = 4;
  expect_parts(refusal_of(gltf.glb()), "invalid layout");
}

TEST_F(GltfTest, RefusesInvalidMeshoptCompression) {
  const auto refuse = [&](std::size_t view, const char* name, Json value,
                          const std::string& cause) {
    GltfWriter gltf = compressed();
    extension_of(gltf, view)[name] = std::move(value);
    expect_parts(refusal_of(gltf.glb(), "a.glb"), "a.glb", cause);
  };
  refuse(0, "mode", "LINES", "accessor 0 has an invalid layout of EXT_meshopt_compression");
  refuse(0, "byteStride", 6, "invalid layout");
  refuse(0, "byteStride", 0, "invalid layout");
  refuse(0, "byteStride", 512, "invalid layout");
  refuse(1, "count", 11, "invalid layout");
  refuse(1, "byteStride", 1, "invalid layout");
  refuse(1, "filter", "EXPONENTIAL", "invalid layout");
  refuse(0, "count", 1'000'000'000'000, "which its compressed bytes cannot hold");
  refuse(0, "count", 40, "another byteLength than its compressed bytes");
  refuse(0, "byteLength", 40, "the compressed bytes of accessor 0 are damaged");
  refuse(1, "mode", "INDICES", "the compressed bytes of accessor 1 are damaged");
  refuse(0, "byteLength", 1'000'000, "ends after the");
  refuse(0, "buffer", 5, "entry 5 of \"buffers\"");
  GltfWriter gltf = compressed();
  gltf.root["bufferViews"][1].erase("extensions");  // only the buffer without bytes is left
  expect_parts(refusal_of(gltf.glb()), "ends after the 0 bytes of its buffer");
  gltf = compressed();
  gltf.root["meshes"][0]["primitives"][0]["extensions"] = {
      {"KHR_draco_mesh_compression", Json::object()}};
  gltf.root["extensionsRequired"].push_back("KHR_draco_mesh_compression");
  expect_parts(refusal_of(gltf.glb()),
               "EXT_meshopt_compression and data compressed with KHR_draco");
}

TEST_F(GltfTest, CountsTrianglesWithoutPoints) {
  GltfWriter gltf = floats();
  const std::size_t faces =
      gltf.add(std::vector<std::uint32_t>{0, 1, 2, 0, 1, 4, 0, 1, 0xffffffff}, kUInt, "SCALAR", 1);
  gltf.root["meshes"][0]["primitives"][0]["indices"] = faces;
  // A second primitive, whose points the wrong index must not reach.
  gltf.root["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}});
  const Scan scan = read(gltf.glb());
  EXPECT_EQ(scan.triangles.size(), 2U);
  ASSERT_EQ(scan.warnings.size(), 1U);
  expect_parts(scan.warnings[0], "2 triangles were dropped");
}

TEST_F(GltfTest, ReadsInlineAndExternalBuffers) {
  const GltfWriter gltf = floats();
  Json root = gltf.root;
  write("a b.bin", gltf.data);
  root["buffers"] = {{{"byteLength", gltf.data.size()}, {"uri", "a%20b.bin"}}};
  EXPECT_EQ(read(root.dump()).triangles.size(), 4U);
  // Three floats 1.0 of a triangle of one point: AACAPw== is 1.0F.
  Json inline_data = floats().root;
  inline_data["buffers"] = {
      {{"byteLength", 12}, {"uri", "data:application/octet-stream;base64,AACAPwAAAEAAAEBA"}}};
  inline_data["bufferViews"] = {{{"buffer", 0}, {"byteLength", 12}}};
  inline_data["accessors"] = {
      {{"bufferView", 0}, {"componentType", kFloat}, {"count", 1}, {"type", "VEC3"}}};
  inline_data["meshes"][0]["primitives"] = {{{"attributes", {{"POSITION", 0}}}, {"mode", 0}}};
  expect_point(read(inline_data.dump()), 0, 1, 2, 3);
  inline_data["buffers"][0]["uri"] = "data:application/octet-stream;base64,AA*APw";
  expect_parts(refusal_of(inline_data.dump()), "base64");
}

TEST_F(GltfTest, RefusesImpossibleStructures) {
  const auto refuse = [&](auto change, const std::string& cause) {
    GltfWriter gltf = floats();
    change(gltf.root);
    expect_parts(refusal_of(gltf.glb(), "a.glb"), "a.glb", cause);
  };
  refuse([](Json& root) { root["accessors"][0]["count"] = 5; }, "accessor 0 ends after");
  refuse([](Json& root) { root["accessors"][0]["count"] = 1'000'000'000'000; }, "accessor 0");
  refuse([](Json& root) { root["accessors"][0]["count"] = -1; }, "\"count\"");
  refuse([](Json& root) { root["accessors"][0]["byteOffset"] = 4; }, "accessor 0 ends after");
  refuse([](Json& root) { root["accessors"][0]["componentType"] = 5124; }, "component type 5124");
  refuse([](Json& root) { root["accessors"][0]["type"] = "VEC2"; },
         "a type that does not fit its use");
  refuse([](Json& root) { root["bufferViews"][0]["byteLength"] = 1'000'000; }, "of its buffer");
  refuse([](Json& root) { root["bufferViews"][0]["byteStride"] = 8; }, "byteStride");
  refuse([](Json& root) { root["bufferViews"][0]["buffer"] = 7; }, "entry 7 of \"buffers\"");
  refuse([](Json& root) { root["accessors"][0]["bufferView"] = 9; }, "entry 9 of \"bufferViews\"");
  refuse([](Json& root) { root["nodes"][0]["mesh"] = 3; }, "entry 3 of \"meshes\"");
  refuse([](Json& root) { root["nodes"][0]["children"] = {0}; }, "tree");
  refuse([](Json& root) { root["nodes"][0]["scale"] = {1, 2}; }, "\"scale\" of a node");
  refuse([](Json& root) { root["nodes"][0]["scale"] = "large"; }, "structure of glTF");
  refuse([](Json& root) { root["asset"] = Json::array(); }, "structure of glTF");
  refuse(
      [](Json& root) {
        root["accessors"][0].erase("bufferView");
        root["accessors"][0]["count"] = 1'000'000'000'000;
      },
      "has no bytes");
}

TEST_F(GltfTest, CutFilesNameBothSizes) {
  const std::string whole = floats().glb();
  expect_parts(refusal_of(whole.substr(0, whole.size() - 4), "a.glb"),
               "states " + std::to_string(whole.size()) + " bytes",
               "holds " + std::to_string(whole.size() - 4));
}

TEST_F(GltfTest, ReportsBytesAfterDeclaredSize) {
  const std::string one = floats().glb();
  EXPECT_TRUE(read(one).warnings.empty());
  EXPECT_TRUE(read(one + std::string(3, '\0')).warnings.empty());
  const Scan joined = read(one + one);
  EXPECT_EQ(joined.triangles.size(), 4U);
  ASSERT_EQ(joined.warnings.size(), 1U);
  expect_parts(joined.warnings[0], std::to_string(one.size()) + " bytes follow the size");
}

TEST_F(GltfTest, ReadsOrRefusesDamage) {
  const std::array<std::string, 2> files = {skinned().glb(), compressed().glb()};
  std::mt19937 random(7);
  unsigned refused = 0;
  for (unsigned round = 0; round < 80; ++round) {
    std::string bytes = files[round % 2];
    for (int change = 0; change < 3; ++change) {
      bytes[20 + random() % (bytes.size() - 20)] = static_cast<char>(random());
    }
    try {
      const Scan scan = read(bytes, "a.glb");
      for (const auto& position : scan.positions) EXPECT_TRUE(position.allFinite());
    } catch (const ReadError& error) {
      expect_parts(error.what(), "a.glb");
      ++refused;
    }
  }
  EXPECT_GT(refused, 20U);
}

}  // namespace
}  // namespace tactree::builder
