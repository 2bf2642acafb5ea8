// Writes the seeds of the fuzz targets: make_seeds FOLDER
//   open_blob/<status>.<what>   small blobs, valid or violating one rule; all but the unsealed
//                               ones have a valid checksum
//   read_scan/<what>            a few points in every format that is read in-process
//   import_mesh/<what>          a triangle in every format of the import process
//   read_device, read_firmware, read_materials, read_rows, read_scene
//                               accepted files, and texts of options
//   read_trace/<format>         a recording of two ticks

#include <elf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bytes_of.hpp"
#include "e57_writer.hpp"
#include "las_writer.hpp"
#include "mesh_writers.hpp"
#include "tactree/builder/model.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/runtime/image_record.hpp"
#include "tactree/simulation/injection.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/telemetry/tick_file.hpp"
#include "wire_seeds.hpp"

namespace {

namespace fs = std::filesystem;
using tactree::builder::Model;
using tactree::core::BlobHeader;
using tactree::core::BlobMaterial;
using tactree::core::Profile;
using tactree::test::bytes_of;
using Bytes = std::vector<std::byte>;

void write(const fs::path& path, std::span<const std::byte> bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) {
    throw std::runtime_error(path.string() + " cannot be written");
  }
}

void write(const fs::path& path, const std::string& text) {
  write(path, std::as_bytes(std::span(text)));
}

// Evenly spread points on a sphere, along a spiral.
Model sphere(int points, Profile profile, Eigen::Vector3d centre, double radius) {
  Model model;
  for (int i = 0; i < points; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / points;
    const double ring = std::sqrt(1.0 - z * z);
    const double angle = 2.399963229728653 * i;
    const Eigen::Vector3d normal(ring * std::cos(angle), ring * std::sin(angle), z);
    model.positions.push_back(centre + radius * normal);
    model.normals.push_back(normal.cast<float>());
  }
  model.profile = profile;
  model.spacing_m = 3.5 * radius / std::sqrt(points);
  model.support_radius_m = 2.5 * model.spacing_m;
  model.reach_m = 3.0 * model.spacing_m;
  model.name = "sphere";
  return model;
}

void give_materials(Model& model, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    BlobMaterial material{};
    material.stiffness_N_m = 300.0F + 100.0F * static_cast<float>(i);
    material.static_friction = 0.4F;
    material.dynamic_friction = 0.3F;
    model.materials.push_back(material);
  }
  for (std::size_t i = 0; i < model.positions.size(); ++i) {
    model.material_indices.push_back(static_cast<std::uint8_t>(i % count));
  }
}

Bytes blob_of(const Model& model) { return tactree::builder::write_blob(model).bytes; }

void write_valid_blobs(const fs::path& folder) {
  Model materials = sphere(60, Profile::kSurface, {0.01, 0.02, 0.0}, 0.02);
  give_materials(materials, 3);
  write(folder / "kOk.surface_materials", blob_of(materials));
  Model material = sphere(20, Profile::kSurface, {0.0, 0.0, 0.5}, 0.02);
  give_materials(material, 1);
  write(folder / "kOk.surface_one_material", blob_of(material));
  write(folder / "kOk.surface", blob_of(sphere(40, Profile::kSurface, {0, 0, 0}, 0.05)));
  write(folder / "kOk.surface_directory", blob_of(sphere(600, Profile::kSurface, {0, 0, 0}, 0.05)));
  write(folder / "kOk.surface_point", blob_of(sphere(1, Profile::kSurface, {0, 0, 0}, 0.05)));
  Model body = sphere(2000, Profile::kSurface, {0, 0, 0}, 0.05);
  body.tells_interior = true;
  write(folder / "kOk.surface_interior", blob_of(body));
  Model paper = sphere(120, Profile::kPaper, {0.0, -0.3, 0.0}, 0.04);
  give_materials(paper, 2);
  write(folder / "kOk.paper_materials", blob_of(paper));
  write(folder / "kOk.paper", blob_of(sphere(30, Profile::kPaper, {0, 0, 0}, 0.04)));
  write(folder / "kOk.paper_point", blob_of(sphere(1, Profile::kPaper, {0, 0, 0}, 0.04)));

  // Two clusters far apart: a deep tree.
  Model deep = sphere(12, Profile::kSurface, {0, 0, 0}, 0.001);
  const Model other = sphere(12, Profile::kSurface, {0.3, 0.2, 0.1}, 0.001);
  deep.positions.insert(deep.positions.end(), other.positions.begin(), other.positions.end());
  deep.normals.insert(deep.normals.end(), other.normals.begin(), other.normals.end());
  write(folder / "kOk.surface_deep", blob_of(deep));
  deep.profile = Profile::kPaper;
  write(folder / "kOk.paper_deep", blob_of(deep));
}

BlobHeader& header_of(Bytes& blob) { return *reinterpret_cast<BlobHeader*>(blob.data()); }

template <typename T>
T* items_of(Bytes& blob, const tactree::core::BlobSection& section) {
  return reinterpret_cast<T*>(blob.data() + section.offset);
}

// One blob per rule, in the order of the validator.
void write_broken_blobs(const fs::path& folder) {
  Model model = sphere(120, Profile::kPaper, {0, 0, 0}, 0.04);
  give_materials(model, 3);
  const Bytes good = blob_of(model);
  const auto broken = [&](const char* name,
                          const std::function<void(Bytes&, BlobHeader&)>& breaks) {
    Bytes bad = good;
    breaks(bad, header_of(bad));
    if (bad.size() >= sizeof(BlobHeader)) {
      tactree::builder::seal(bad);
    }
    write(folder / name, bad);
  };
  broken("kTooShort.header", [](Bytes& b, BlobHeader&) { b.resize(sizeof(BlobHeader) - 1); });
  broken("kBadMagic.letter", [](Bytes&, BlobHeader& h) { h.magic[3] = 'X'; });
  broken("kBadVersion.newer", [](Bytes&, BlobHeader& h) { ++h.version_major; });
  broken("kBadSize.prefix", [](Bytes& b, BlobHeader&) { b.resize(b.size() - 4); });
  broken("kBadHeader.depth", [](Bytes&, BlobHeader& h) { h.depth = 12; });
  broken("kBadHeader.counts", [](Bytes&, BlobHeader& h) { h.leaf_count = h.point_count + 1; });
  broken("kBadFigures.step",
         [](Bytes&, BlobHeader& h) { h.step_m = std::nextafter(h.step_m, 1.0F); });
  broken("kBadFigures.root", [](Bytes&, BlobHeader& h) { h.root_min[1] = -(1 << 22) - 1; });
  broken("kBadSections.gap", [](Bytes&, BlobHeader& h) { h.leaf_bases.offset += 4; });
  broken("kBadSections.size", [](Bytes&, BlobHeader& h) { h.points.bytes = 0xFFFFFFFC; });
  broken("kBadLeaves.empty_leaf",
         [](Bytes& b, BlobHeader& h) { items_of<std::uint16_t>(b, h.leaf_offsets)[1] = 0; });
  broken("kBadTree.cycle", [](Bytes& b, BlobHeader& h) {
    auto& root = items_of<tactree::core::BlobNode>(b, h.nodes)[0];
    root.nodes &= 0xFF000000U;
  });
  broken("kBadTree.both", [](Bytes& b, BlobHeader& h) {
    auto& root = items_of<tactree::core::BlobNode>(b, h.nodes)[0];
    root.leaves |= root.nodes & 0xFF000000U;
  });
  broken("kBadPoints.order",
         [](Bytes& b, BlobHeader& h) { items_of<std::uint32_t>(b, h.points)[0] = 0xFFFFFFFF; });
  broken("kBadNeighbours.leaf", [](Bytes& b, BlobHeader& h) {
    items_of<std::uint32_t>(b, h.neighbours)[5] = h.leaf_count;
  });
  broken("kBadMaterials.friction", [](Bytes& b, BlobHeader& h) {
    items_of<BlobMaterial>(b, h.materials)[1].dynamic_friction = 0.5F;
  });
  broken("kBadMaterials.index",
         [](Bytes& b, BlobHeader& h) { items_of<std::uint8_t>(b, h.material_indices)[0] = 3; });
  Bytes listed = blob_of(sphere(600, Profile::kSurface, {0, 0, 0}, 0.05));
  items_of<std::uint32_t>(listed, header_of(listed).directory)[0] ^= 1U;
  tactree::builder::seal(listed);
  write(folder / "kBadTree.directory", listed);
  Model body = sphere(2000, Profile::kSurface, {0, 0, 0}, 0.05);
  body.tells_interior = true;
  Bytes marked = blob_of(body);
  marked[sizeof(BlobHeader) + sizeof(tactree::core::BlobExtension)] = std::byte{0xFF};
  tactree::builder::seal(marked);
  write(folder / "kBadTree.interior", marked);
  Bytes longer = blob_of(body);
  ++items_of<tactree::core::BlobExtension>(longer, {sizeof(BlobHeader), 0})->interior.bytes;
  tactree::builder::seal(longer);
  write(folder / "kBadSections.interior", longer);
  Bytes flipped = good;
  flipped.back() ^= std::byte{1};
  write(folder / "kBadChecksum.bit", flipped);
  write(folder / "kTooShort.nothing", Bytes{});
}

std::string ply_with_lists(const std::string& format, const std::string& body) {
  return "ply\nformat " + format +
         " 1.0\nelement vertex 4\nproperty float x\nproperty double y\nproperty short z\n"
         "property list uchar int tags\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nelement face 2\nproperty list uchar int "
         "vertex_indices\nend_header\n" +
         body;
}

std::string ply_binary(bool big_endian) {
  std::string body;
  for (int i = 0; i < 4; ++i) {
    body += bytes_of(static_cast<float>(i), big_endian) + bytes_of(1.0 * i * i, big_endian) +
            bytes_of(std::int16_t{5}, big_endian) + '\x01' + bytes_of(7, big_endian) + "rgb";
  }
  body += '\x04';
  for (const int corner : {0, 1, 2, 3}) {
    body += bytes_of(corner, big_endian);
  }
  body += '\x03';
  for (const int corner : {0, 1, 2}) {
    body += bytes_of(corner, big_endian);
  }
  return ply_with_lists(big_endian ? "binary_big_endian" : "binary_little_endian", body);
}

/// Three corners with normals and colours, and the triangle between them.
std::string off_binary() {
  std::string out = "CNOFF BINARY\n";
  for (const std::int32_t count : {3, 1, 0}) {
    out += bytes_of(count, true);
  }
  for (const auto& [x, y] :
       {std::array{0.0F, 0.0F}, std::array{1.0F, 0.0F}, std::array{0.0F, 1.0F}}) {
    for (const float value : {x, y, 0.0F, 0.0F, 0.0F, 1.0F, 1.0F, 0.5F, 0.0F, 1.0F}) {
      out += bytes_of(value, true);
    }
  }
  for (const std::int32_t corner :
       {3, 0, 1, 2, 0}) {  // the first is the count, the last of colours
    out += bytes_of(corner, true);
  }
  return out;
}

std::string stl_binary() {
  std::string out(80, ' ');
  out += bytes_of(std::uint32_t{2});
  for (int triangle = 0; triangle < 2; ++triangle) {
    for (int i = 0; i < 12; ++i) {
      out += bytes_of(static_cast<float>((triangle + i * i) % 5));
    }
    out += bytes_of(std::uint16_t{0});
  }
  return out;
}

std::string pcd(const std::string& data, const std::string& body) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\n"
         "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA " +
         data + "\n" + body;
}

void write_laser_scans(const fs::path& folder) {
  using namespace tactree::test;
  E57TestScan cartesian = {
      {e57_double("cartesianX", {0, 1, 2}), e57_single("cartesianY", {0, 1, 1}),
       e57_integer("cartesianZ", -9, 300, {-9, 0, 300}, R"(scale="0.5")"),
       e57_integer("cartesianInvalidState", 0, 2, {0, 1, 0})},
      e57_pose("1 0 0 0", "0 0 5"),
      7,
      ""};
  for (const char* name : {"colorRed", "colorGreen", "colorBlue"}) {
    cartesian.columns.push_back(e57_integer(name, 0, 255, {1, 2, 3}));
  }
  const E57TestScan spherical = {
      {e57_double("sphericalRange", {1, 2}), e57_double("sphericalAzimuth", {0, 1}),
       e57_double("sphericalElevation", {0, 1})},
      "",
      9,
      ""};
  write(folder / "e57_cartesian", e57_file({cartesian}));
  write(folder / "e57_two_scans", e57_file({spherical, cartesian}));
  LasFile las;
  las.points = {{{1, 2, 3}, {1, 2, 300}}, {{5, 6, 7}, {3, 2, 1}}, {{4, 5, 6}, {7, 8, 9}, true}};
  las.records = las_geo_keys({{1024, 1}, {3076, 9002}});
  las.record_count = 1;
  write(folder / "las_1_2", las_file(las));
  las.minor = 4;
  las.point_format = 7;
  las.records = las_record("LASF_Projection", 2112, R"(PROJCS["p",UNIT["metre",1]])");
  write(folder / "las_1_4", las_file(las));
}

void write_scans(const fs::path& folder) {
  std::string floats;
  for (int i = 0; i < 9; ++i) {
    floats += bytes_of(0.25F * static_cast<float>(i));
  }
  // A compressed body of LZF literal runs only.
  std::string runs;
  runs += bytes_of(static_cast<std::uint8_t>(31));
  runs += floats.substr(0, 32);
  runs += bytes_of(static_cast<std::uint8_t>(3));
  runs += floats.substr(32);
  std::string compressed;
  compressed += bytes_of(static_cast<std::uint32_t>(runs.size()));
  compressed += bytes_of(static_cast<std::uint32_t>(floats.size()));
  compressed += runs;

  write(
      folder / "ply_ascii",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n"
      "0 1 0 0 0 1\n3 0 1 2\n");
  write(folder / "ply_lists", ply_with_lists("ascii",
                                             "0 0 0 0 1 2 3\n1 0 0 1 9 1 2 3\n1 1 0 2 9 9 1 2 3\n"
                                             "0 1 0 0 1 2 3\n4 0 1 2 3\n3 0 1 2\n"));
  write(folder / "ply_little_endian", ply_binary(false));
  write(folder / "ply_big_endian", ply_binary(true));
  write(folder / "pcd_ascii", pcd("ascii", "0 0 0\n1 0 0\nnan nan nan\n"));
  write(folder / "pcd_binary", pcd("binary", floats));
  write(folder / "pcd_compressed", pcd("binary_compressed", compressed));
  write(folder / "xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0.5\n");
  write(folder / "pts", "3\n0 0 0 12 255 0 0\n1 0 0 12 0 255 0\n0 1 0 12 0 0 255\n");
  write(folder / "csv", "x,y,z,red,green,blue\n0,0,0,1,2,3\n1,0,0,1,2,3\n0,1,0,1,2,3\n");
  std::string normals = "//X,Y,Z,Nx,Ny,Nz\n3\n";
  for (int i = 0; i < 20; ++i) {
    normals += std::to_string(i) + ",2,-3e2,0,0,1\n";
  }
  write(folder / "csv_normals", normals);
  write(folder / "csv_semicolon", "\"X\";\"Y\";\"Z\"\r\n0,5;1,5;2,5\r\n1,5;1,5;2,5\r\n2,5;1;2\r\n");
  write(folder / "obj",
        "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0 1 0 0\nvn 0 0 1\n"
        "f 1//1 2//1 3//1 4//1\nf -1 -2 \\\n-3\n");
  write(folder / "ptx",
        "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n"
        "2 1 1 0.5 9 8 7\n2 1 0 0.5 9 8 7\n2 0 1 0.5 9 8 7\n0 0 0 0.5 0 0 0\n");
  write_laser_scans(folder);
  write(folder / "off_binary", off_binary());
  write(folder / "off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n");
  write(folder / "stl_ascii",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid a\n");
  write(folder / "stl_binary", stl_binary());
}

void write_devices(const fs::path& folder) {
  for (const std::string& name : tactree::support::device_names()) {
    write(folder / name, tactree::support::device_json(tactree::support::load_device(name)));
  }
}

constexpr std::uint32_t kCode = 0x08000000;

/// An image with one segment after the headers.
std::string image_of(int machine, const std::string& code) {
  Elf32_Ehdr header{};
  std::memcpy(header.e_ident, ELFMAG, SELFMAG);
  header.e_ident[EI_CLASS] = ELFCLASS32;
  header.e_ident[EI_DATA] = ELFDATA2LSB;
  header.e_type = ET_EXEC;
  header.e_machine = static_cast<Elf32_Half>(machine);
  header.e_phoff = sizeof header;
  header.e_phentsize = sizeof(Elf32_Phdr);
  header.e_phnum = 1;
  Elf32_Phdr segment{};
  segment.p_type = PT_LOAD;
  segment.p_offset = sizeof header + sizeof segment;
  segment.p_paddr = kCode;
  segment.p_filesz = static_cast<Elf32_Word>(code.size());
  return bytes_of(header) + bytes_of(segment) + code;
}

/// Code that ends with the sealed record of a firmware outside this tree, and so with its checksum.
std::string code_with_record() {
  std::string code(256, '\x42');
  auto record = tactree::runtime::image_record(
      "board", {.clock_hz = 150'000'000, .blob_at = kCode + 0x20000, .blob_room = 0x20000});
  record.count = 1;
  record.ranges[0] = {kCode, static_cast<std::uint32_t>(code.size() + sizeof record)};
  record.checksum_at = kCode + static_cast<std::uint32_t>(code.size()) +
                       offsetof(tactree::runtime::ImageRecord, checksum);
  code += bytes_of(record);
  code.resize(code.size() - sizeof record.checksum);
  return code + bytes_of(tactree::core::crc32(std::as_bytes(std::span(code))));
}

// The code ends with the identity (firmware/runtime/identity.hpp).
void write_firmware(const fs::path& folder) {
  std::string code(256, '\x42');
  code += std::string("TACTIMG\0", 8) + "board" + std::string(19, '\0');
  for (const std::uint32_t word : {kCode, kCode + 0x10000, kCode + 0x20000, kCode + 0x40000, 0U}) {
    code += bytes_of(word);
  }
  code += bytes_of(tactree::core::crc32(std::as_bytes(std::span(code))));
  write(folder / "arm", image_of(EM_ARM, code));
  write(folder / "riscv", image_of(EM_RISCV, code));
  write(folder / "own", image_of(EM_ARM, code_with_record()));
}

void write_materials(const fs::path& folder) {
  const std::string steel =
      R"("stiffness_N_m": 800, "damping_Ns_m": 1.5, "static_friction": 0.5, "dynamic_friction": 0.4,)"
      R"( "texture_height_m": 1e-4, "texture_wavelength_m": 2e-3)";
  write(folder / "one", "{" + steel + "}");
  write(folder / "colours", "{\"default\": {" + steel +
                                "}, \"colours\": [{\"name\": \"felt\", \"rgb\": [255, 0, 0], "
                                "\"tolerance\": 30, \"stiffness_N_m\": 200}]}");
  write(folder / "option", std::string("=800,damping=1.5,static=0.5,dynamic=0.4,") +
                               "texture_height=1e-4,texture_wavelength=2e-3");
}

void write_traces(const fs::path& folder) {
  std::array<tactree::telemetry::Tick, 2> ticks;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ticks[i].time_us = 1000 * i;
    ticks[i].telemetry.header.tick = static_cast<std::uint32_t>(i);
    ticks[i].telemetry.header.fields = tactree::telemetry::kRecordedFields;
    ticks[i].telemetry.state = static_cast<std::uint32_t>(tactree::core::State::kActive);
  }
  for (const char* const name : {"trace.csv", "trace.npz"}) {
    const auto file = tactree::telemetry::open_tick_file(folder / name);
    file->append(ticks);
    file->finish();
  }
}

void write_rows(const fs::path& folder) {
  write(folder / "points", "x,y,z\n# a remark\n0.1,0.2,0.3\n1e-3;2;+3\n\n");
  write(folder / "path", "t_s,x,y,z\n0,0,0,0.01\n0.2,0,0,-0.002\n1 0 0 -0.002\n");
  for (const auto& kind : tactree::simulation::injection_kinds()) {
    std::string text(kind.name);
    const std::size_t value = text.find('=');
    text = (value == std::string::npos ? text : text.substr(0, value) + "=2") + "@1s..1.5s";
    std::string name = text;
    std::replace(name.begin(), name.end(), ':', '_');
    write(folder / name, text);
  }
}

void write_scenes(const fs::path& folder) {
  const std::string pose = "[1,0,0,0.1, 0,1,0,0, 0,0,1,0, 0,0,0,1]";
  write(folder / "moving", R"({"bodies": [{"blob": 0, "pose": )" + pose +
                               R"(, "linear_velocity_m_s": [0, 0, 0.01],)"
                               R"( "angular_velocity_rad_s": [0, 0, 1]}]})");
  write(folder / "keyframes",
        R"({"bodies": [{"blob": 0}, {"blob": "a.blob", "keyframes": [{"t_s": 0, "pose": )" + pose +
            R"(}, {"t_s": 2, "pose": )" + pose + R"(}], "from_s": 1, "until_s": 3}]})");
}

void write_meshes(const fs::path& folder) {
  using tactree::test::GltfWriter;
  using tactree::test::ZipWriter;
  const std::string mesh =
      R"(<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="2" z="0"/></vertices><triangles><triangle v1="0" v2="2" v3="1" pid="1" p1="0"/></triangles></mesh>)";
  const std::string part =
      R"(<model unit="inch"><resources><basematerials id="1"><base name="a" displaycolor="#FF8000"/></basematerials><object id="2">)" +
      mesh +
      R"(</object><object id="3"><components><component objectid="2" transform="0 1 0 1 0 0 0 0 1 5 6 7"/></components></object></resources><build><item objectid="3"/></build></model>)";
  write(folder / "3mf_document", part);
  write(
      folder / "3mf",
      ZipWriter()
          .add(
              "_rels/.rels",
              R"(<Relationships><Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)")
          .add("3D/3dmodel.model", part)
          .bytes());
  std::string vertices;
  for (const char* const x : {"0", "1.5", "+3e0"}) {
    vertices += std::string("<vertex><coordinates><x>") + x +
                "</x><y>2</y><z>0</z></coordinates><color><r>1</r><g>0.5</g><b>0</b></color>"
                "</vertex>";
  }
  write(
      folder / "amf",
      R"(<amf unit="feet"><object id="1"><mesh><vertices>)" + vertices +
          R"(</vertices><volume><triangle><v1>0</v1><v2>1</v2><v3>2</v3></triangle></volume></mesh></object><constellation id="2"><instance objectid="1"><deltax>1</deltax><rz>90</rz></instance></constellation></amf>)");
  write(
      folder / "collada",
      R"(<COLLADA><asset><unit meter="0.01"/></asset><library_geometries><geometry id="g"><mesh/></geometry></library_geometries><scene><node><instance_geometry url="#g"/></node></scene></COLLADA>)");
  write(
      folder / "x3d",
      R"(<X3D><head><unit category="length" conversionFactor="0.01"/></head><Scene><Transform><Shape><IndexedFaceSet coordIndex="0 1 2 -1"><Coordinate point="0 0 0 1 0 0 0 1 0"/></IndexedFaceSet></Shape></Transform></Scene></X3D>)");
  GltfWriter gltf;
  const std::size_t positions = gltf.add<float>({0, 0, 0, 1, 0, 0, 0, 2, 0}, 5126, "VEC3", 3);
  const std::size_t colours =
      gltf.add<std::uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 255}, 5121, "VEC3", 3);
  const std::size_t corners = gltf.add<std::uint16_t>({0, 1, 2}, 5123, "SCALAR", 1);
  gltf.root["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", positions}, {"COLOR_0", colours}}}, {"indices", corners}});
  gltf.root["nodes"][0]["scale"] = {1, 2, 3};
  write(folder / "glb", gltf.glb());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_seeds FOLDER\n");
    return 2;
  }
  try {
    const fs::path folder = argv[1];
    fs::remove_all(folder);
    fs::create_directories(folder / "open_blob");
    for (const char* name : {"import_mesh", "read_scan", "read_device", "read_firmware",
                             "read_materials", "read_rows", "read_scene", "read_trace"}) {
      fs::create_directories(folder / name);
    }
    write_valid_blobs(folder / "open_blob");
    write_broken_blobs(folder / "open_blob");
    write_scans(folder / "read_scan");
    write_meshes(folder / "import_mesh");
    fs::create_directories(folder / "wire_session");
    write_wire_sessions(folder / "wire_session");
    write_devices(folder / "read_device");
    write_firmware(folder / "read_firmware");
    write_materials(folder / "read_materials");
    write_rows(folder / "read_rows");
    write_traces(folder / "read_trace");
    write_scenes(folder / "read_scene");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_seeds: %s\n", error.what());
    return 1;
  }
  return 0;
}
