#include "recognise.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include "test_files.hpp"

namespace tactree::builder {
namespace {

using namespace std::string_literals;

class RecogniseTest : public TestFiles {};

TEST_F(RecogniseTest, UsesContentNotName) {
  EXPECT_EQ(read("v 1 2 3\n", "points.ply").format, "OBJ");
  EXPECT_EQ(read("1 2 3\n", "mesh.stl").format, "text, separated by spaces");
  EXPECT_EQ(read("OFF\n1 0 0\n1 2 3\n", "cloud.pcd").format, "OFF");
}

TEST_F(RecogniseTest, NamesUnsupportedFormats) {
  struct Case {
    std::string bytes;
    std::string name;
  };
  std::string laz = "LASF" + std::string(223, '\0');
  laz[104] = static_cast<char>(0x83);
  const Case cases[] = {
      {laz, "LAZ file"},
      {"DRACO\2\2\1\1"s, "Draco"},
      {"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"s, "PNG"},
      {"\xff\xd8\xff\xe0\0\x10JFIF"s, "JPEG"},
      {"<!DOCTYPE html><html></html>", "HTML"},
      {"\n <HTML><body>404</body></HTML>", "HTML"},
      {"PK\x03\x04\x14\0\0\0"s, "zip"},
      {"\x1f\x8b\x08\0\0"s, "gzip"},
      {"%PDF-1.7\n", "PDF"},
      {"{\"type\": \"FeatureCollection\"}", "JSON"},
      {"<?xml version=\"1.0\"?><note/>", "XML"},
      {"\xff\xfe"
       "1\0 \0"s,
       "UTF-16"},
      {"version https://git-lfs.github.com/spec/v1\noid sha256:00\n", "LFS"},
      {"ISO-10303-21;\nHEADER;\n", "CAD"},
      {"\0\1\2\3\4\5\6\7"s, "not a scan"},
      {std::string(5000, '\0'), "not a scan"},
  };
  for (const Case& one : cases) {
    const std::string message = refusal_of(one.bytes, "thing.ply");
    expect_parts(message, "thing.ply", one.name);
    EXPECT_EQ(message.back(), ')') << "no remedy: " << message;
  }
}

/// The name of the format is the user's; the content contradicts it only if it is surely another.
TEST_F(RecogniseTest, UsesNamedFormat) {
  const auto kind = [](const char* name, const std::string& bytes) {
    return recognise_as(name, bytes, bytes.size()).kind;
  };
  EXPECT_EQ(scan_formats().front(), "ply");
  EXPECT_EQ(kind("ply", "ply\n"), FileKind::kPly);
  EXPECT_EQ(kind("PLY", "ply\n"), FileKind::kPly);
  EXPECT_EQ(kind("stl", "ply\n"), FileKind::kUnsupported);
  EXPECT_EQ(kind("xyz", "v 1 2 3\n"), FileKind::kText);  // an OBJ by its content
  EXPECT_EQ(kind("xyz", "ASTM-E57\1\2"), FileKind::kUnsupported);
  EXPECT_EQ(kind("xyz", "\1\2\3"), FileKind::kUnsupported);
  EXPECT_EQ(kind("csv", "$MeshFormat\n1 2 3\n"), FileKind::kText);
  EXPECT_EQ(kind("stl", "solid"), FileKind::kStlAscii);
  EXPECT_EQ(kind("stl", "GIF8\1"), FileKind::kStlBinary);
  EXPECT_EQ(kind("off", "1 2 3\n"), FileKind::kOff);
  EXPECT_EQ(kind("off", "\1\2\3"), FileKind::kOffBinary);
  EXPECT_EQ(recognise_as("dae", "<a/>", 4).hint, "dae");
  EXPECT_EQ(kind("glb", "{\"asset\":{}}"), FileKind::kUnsupported);  // the text form: gltf
  EXPECT_EQ(kind("gltf", "{\"asset\":{}}"), FileKind::kImportedMesh);
  EXPECT_EQ(kind("doc", "1 2 3\n"), FileKind::kUnsupported);
  std::string laz = "LASF" + std::string(223, '\0');
  EXPECT_EQ(kind("las", laz), FileKind::kLas);
  laz[104] = static_cast<char>(0x83);
  expect_parts(recognise_as("las", laz, laz.size()).remedy, "laszip -i FILE -o scan.las",
               "pdal translate FILE scan.las");
}

TEST_F(RecogniseTest, LabelsMessagesAsTold) {
  ReadOptions options;
  options.label = "standard input";
  for (const char* const bytes : {"ply\nformat nonsense\n", "PK\3\4 3D/ [Content_Types].xml"}) {
    const std::string message = refusal(write("a.scan", bytes), options);
    EXPECT_EQ(message.find("standard input: "), 0U) << message;
    EXPECT_EQ(message.find("a.scan"), std::string::npos) << message;
  }
}

TEST_F(RecogniseTest, RefusesFoldersAndMissingFiles) {
  expect_parts(refusal(folder_ / "absent.ply"), "absent.ply", "no such file");
  expect_parts(refusal(folder_), "a directory");
  expect_parts(refusal(write("empty.ply", "")), "empty.ply", "empty (0 bytes)");
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  expect_parts(refusal(folder_ / "pipe"), "a pipe");
  expect_parts(refusal("/dev/zero"), "a device");
}

TEST_F(RecogniseTest, RefusesFilesWithoutReadPermission) {
  const auto path = write("secret.ply", "ply\n");
  std::filesystem::permissions(path, std::filesystem::perms::none);
  const bool root = ::geteuid() == 0;  // which may read every file
  constexpr ::uid_t kNobody = 65534;
  ASSERT_EQ(root ? ::seteuid(kNobody) : 0, 0);
  const std::string why = refusal(path);
  ASSERT_EQ(root ? ::seteuid(0) : 0, 0);
  expect_parts(why, "secret.ply", "permission denied");
}

TEST_F(RecogniseTest, LeavesInputUnmodified) {
  const std::string bytes = "v 1 2 3\nv 4 5 6\n";
  const auto path = write("a.obj", bytes);
  std::filesystem::permissions(path, std::filesystem::perms::owner_read);
  const auto before = std::filesystem::last_write_time(path);
  (void)read_scan(path);
  EXPECT_EQ(std::filesystem::last_write_time(path), before);
  std::ifstream in(path, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), bytes);
}

TEST_F(RecogniseTest, RecognisesImportedMeshes) {
  EXPECT_EQ(recognise("glTF\2\0\0\0", 100).hint, "glb");
  EXPECT_EQ(recognise("{ \"asset\": {\"version\": \"2.0\"}}", 100).hint, "gltf");
  EXPECT_EQ(recognise("<?xml version=\"1.0\"?>\n<COLLADA>", 100).hint, "dae");
  EXPECT_EQ(recognise("Kaydara FBX Binary  ", 100).hint, "fbx");
  EXPECT_EQ(recognise("MM\x40\0\0\0\2\0\x0a\0\0\0\3\0\0\0"s, 64).hint, "3ds");
}

TEST_F(RecogniseTest, ReportsLineOfTextDamage) {
  expect_parts(refusal_of("v 0 0 0\nv 1 \0 0\nv 1 1 0\nf 1 2 3\n"s), "line 2", "the point");
}

TEST_F(RecogniseTest, ProseIsNotObj) {
  EXPECT_EQ(recognise("o how the wind blows\nv. the sea\n", 100).kind, FileKind::kText);
  EXPECT_EQ(recognise("g An f Three Other Things\nv 388.0 778.0 347.1", 100).kind, FileKind::kObj);
}

}  // namespace
}  // namespace tactree::builder
