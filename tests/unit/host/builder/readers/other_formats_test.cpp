// Meshes, grids and tables of other programs: each is named and refused with a hint, and none of
// its numbers becomes a point.

#include <string>
#include <vector>

#include "test_files.hpp"

namespace tactree::builder {
namespace {

using namespace std::string_literals;

class OtherFormatsTest : public TestFiles {};

/// Rows "1 x y z" of a flat grid of points, as mesh formats list their nodes.
std::string nodes(const std::string& before, const std::string& between, int first = 1) {
  std::string text;
  for (int i = 0; i < 100; ++i) {
    text += before + std::to_string(first + i) + between + std::to_string(0.001 * (i % 10)) +
            between + std::to_string(0.001 * (i / 10.0)) + between + "0.5\n";
  }
  return text;
}

std::string rows(int count, const std::string& row) {
  std::string text;
  for (int i = 0; i < count; ++i) text += row + "\n";
  return text;
}

std::string iges_line() {
  std::string line(80, ' ');
  line.replace(0, 4, "test");
  line.replace(72, 8, "S      1");
  return line + "\n" + line + "\n";
}

struct ForeignFile {
  std::string text;
  std::string name;
};

std::vector<ForeignFile> meshes() {
  const std::string xyz = rows(100, "0.001 0.002 0.003");
  return {
      {"# vtk DataFile Version 4.2\nvtk output\nASCII\nDATASET POLYDATA\nPOINTS 300 float\n" +
           rows(100, "0.005 -0.004 0.019 0.0089 -0.004 0.018 0.0088 -0.003 0.017"),
       "VTK file (legacy .vtk)"},
      {"# vtk DataFile Version 4.2\nvtk output\nBINARY\nDATASET POLYDATA\n\0\1\2"s,
       "VTK file (legacy .vtk)"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n100\n" + nodes("", " ") + "$EndNodes\n",
       "Gmsh mesh"},
      {"$NOD\n100\n" + nodes("", " ") + "$ENDNOD\n", "Gmsh mesh"},
      {"100 3 0 0\n" + nodes("", " "), "TetGen"},
      {"100 3 0 0\n" + nodes("  ", "  ", 0), "TetGen"},
      {"# a comment\n100 4 0\n" + nodes("", " "), "TetGen"},
      {"830 3 0 0\n" + nodes("", " ") + "101 0.0", "TetGen"},  // cut off
      {"100 50 0 0 0\n" + nodes("", " ") + rows(50, "1 0 tri 1 2 3"), "AVS-UCD"},
      {"100 7 0 0 0 0 0\n" + xyz + rows(7, "1 2 3"), "UGRID"},
      {"100 7 3\n" + rows(100, "0.5 0.25 0") + rows(7, "1 2 3 0") + rows(3, "1 2 0"), "FreeFem"},
      {"*HEADING\n*NODE\n" + nodes("", ", ") + "*ELEMENT, TYPE=S3\n1, 1, 2, 3\n", "Abaqus"},
      {"*KEYWORD\n*NODE\n" + nodes("", " "), "LS-DYNA"},
      {"SOL 101\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\n", "Nastran"},
      {"$ comment\nGRID           1       0      0.      1.      2.\n", "Nastran"},
      {"GRID*                  1               0              0.              1.*\n", "Nastran"},
      {"% comment\nNDIME= 3\nNPOIN= 100\n" + nodes("", " "), "SU2"},
      {"TITLE = \"a\"\nVARIABLES = \"X\", \"Y\", \"Z\"\nZONE I=100\n" + xyz, "Tecplot"},
      {"VARIABLES=X Y Z\nZONE I=100\n" + xyz, "Tecplot"},
      {"MeshVersionFormatted 1\nDimension 3\nVertices\n100\n" + rows(100, "0.1 0.2 0.3 0"),
       "Medit"},
      {"mesh3d\ndimension\n3\npoints\n100\n" + xyz, "Netgen"},
      {"* FLAC3D grid produced by test\n* GRIDPOINTS\n" + nodes("G  ", "  "), "FLAC3D"},
      {"Begin ModelPartData\nEnd ModelPartData\nBegin Nodes\n" + nodes("", " "), "Kratos"},
      {"$ENTER COMPONENT NAME=a\n" + nodes("", " "), "PERMAS"},
      {"    -1\n  2411\n" + rows(50, "1 1 1 11\n 0.1 0.2 0.3") + "    -1\n", "I-DEAS"},
      {"(0 \"grid\")\n(2 3)\n(10 (0 1 64 0 3))\n" + xyz, "Fluent"},
      {"#!ascii version of lh.white\n100 50\n" + rows(100, "0.1 0.2 0.3 0"), "FreeSurfer"},
      {"/*---*- C++ -*---*/\nFoamFile\n{\n}\n100\n(\n" + rows(100, "(0.1 0.2 0.3)") + ")\n",
       "OpenFOAM"},
      {"FORMAT\ntype: ensight gold\n", "EnSight"},
      {"GOCAD TSurf 1\nHEADER {\n}\n" + nodes("VRTX ", " "), "GOCAD"},
      {"# AmiraMesh 3D ASCII 2.0\n" + xyz, "Amira"},
      {"#Inventor V2.1 ascii\nSeparator {\n}\n", "Open Inventor"},
      {"//Maya ASCII 2020 scene\n", "Maya"},
      {"#usda 1.0\ndef Mesh \"a\" {}\n", "USD"},
      {"# Bundle file v0.3\n1 100\n" + xyz, "Bundler"},
      {"TIN Z (((0 0 0, 1 0 0, 0 1 0, 0 0 0)))\n", "WKT"},
      {"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">\n</VTKFile>\n", "VTK file (.vtu"},
      {"<Xdmf Version=\"3.0\">\n</Xdmf>\n", "XDMF"},
      {"\x89HDF\r\n\x1a\n\0\0"s, "HDF5"},
      {"CDF\1\0\0\0\0"s, "NetCDF"},
  };
}

std::vector<ForeignFile> others() {
  const std::string heights = rows(40, "0.02 0.021 0.022 0.023 0.024 0.025");
  return {
      {"ncols 6\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize 0.001\n" + heights, "ESRI grid"},
      {"NCOLS        6\r\nNROWS 40\r\n" + heights, "ESRI grid"},
      {"north: 5\nsouth: 0\n" + heights, "GRASS grid"},
      {"DSAA\n6 40\n0 1\n0 1\n0 1\n" + heights, "Surfer grid"},
      {"DSBB\6\0\6\0\0\0\0\0"s, "Surfer grid"},
      {"  0\nSECTION\n  2\nENTITIES\n", "DXF"},
      {"999\nmade for a test\n0\nSECTION\n", "DXF"},
      {iges_line(), "IGES"},
      {"DBRep_DrawableShape\n\nCASCADE Topology V1\n", "OpenCASCADE"},
      {"3\nwater\nO 0.0 0.0 0.1\nH 0.0 0.7 -0.4\nH 0.0 -0.7 -0.4\n", "molecule (XYZ"},
      {"3\n\nO 0.0 0.0 0.1\nH 0.0 0.7 -0.4\nH 0.0 -0.7 -0.4\n", "molecule (XYZ"},
      {"HEADER    TEST\nATOM      1  N   ALA A   1      11.104   6.134  -6.504  1.00  0.00\n",
       "molecule (PDB)"},
      {"G21\nG90\nG1 X10.5 Y2 Z0.2\n", "G-code"},
      {"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\n", "NMEA"},
      {"\x93NUMPY\1\0v\0{'descr': '<f8'}"s, "NumPy"},
      {"CCB2\0\0\0\0"s, "CloudCompare file"},
      {"NRRD0004\ntype: float\n", "NRRD"},
  };
}

TEST_F(OtherFormatsTest, AreNamedWithRemedy) {
  std::vector<ForeignFile> cases = meshes();
  for (ForeignFile& other : others()) cases.push_back(std::move(other));
  for (const ForeignFile& one : cases) {
    const std::string message = refusal_of(one.text, "thing.xyz");
    expect_parts(message, "thing.xyz", one.name, "which has no reader");
    EXPECT_EQ(message.back(), ')') << "no remedy: " << message;
  }
}

/// Tables of points that begin nearly like one of the formats above.
TEST_F(OtherFormatsTest, ReadsSimilarPointTables) {
  const std::string xyz = rows(50, "0.1 0.2 0.3");
  const std::string cases[] = {
      "zone,x,y,z\n1,0.1,0.2,0.3\n1,0.4,0.5,0.6\n",
      "atom x y z\n7 0.1 0.2 0.3\n4 0.4 0.5 0.6\n",
      "tin x y z\n7 0.1 0.2 0.3\n4 0.4 0.5 0.6\n",
      "node,x,y,z\n1,0.1,0.2,0.3\n2,0.4,0.5,0.6\n",
      "50\n" + xyz,
      "10 0 0\n0 5 5\n1 5 5\n2 5 5\n3 5 5\n",
      "7 5 5 5 5 5 5\n8 5 5 5 5 5 5\n3 5 5 5 5 5 5\n",
  };
  for (const std::string& text : cases) EXPECT_GE(read(text).positions.size(), 2U) << text;
}

TEST_F(OtherFormatsTest, ReadsMisnumberedRowsAsPoints) {
  std::string text = "120 0 0\n";
  for (int i = 0; i < 100; ++i) text += std::to_string(i) + " 5 5\n";
  for (int i = 0; i < 30; ++i) text += "3 1 1\n";
  EXPECT_EQ(read(text).positions.size(), 131U);
}

TEST_F(OtherFormatsTest, NamedColumnsReadAnyText) {
  const auto path = write("a.node", "100 3 0 0\n" + nodes("", " "));
  const Scan scan = read_scan(path, columns("x=2,y=3,z=4"));
  EXPECT_EQ(scan.positions.size(), 101U);
  EXPECT_EQ(scan.positions.at(100), Eigen::Vector3d(0.009, 0.0099, 0.5));
}

TEST_F(OtherFormatsTest, NamedColumnsRequireText) {
  expect_parts(refusal(write("a.obj", "v 1 2 3\n"), columns("x=2,y=3,z=4")), "a.obj", "OBJ",
               "--columns");
  expect_parts(refusal(write("a.pdf", "%PDF-1.7\n\1\2"), columns("x=2,y=3,z=4")), "a.pdf", "PDF");
}

}  // namespace
}  // namespace tactree::builder
