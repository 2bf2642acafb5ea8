// Meshes, grids and tables of other programs: each is named and refused with a hint, and none of
// its numbers becomes a point.

#include <string>
#include <vector>

#include "recognise.hpp"
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
      {"\xd4\xc3\xb2\xa1\2\0\4\0"s, "network packets (.pcap)"},
      {"\n\r\r\n\x1c\0\0\0\x4d\x3c\x2b\x1a"s, "network packets (.pcapng)"},
  };
}

/// The formats above in other forms, and formats of other programs.
std::vector<ForeignFile> more_meshes() {
  const std::string xyz = rows(100, "0.001 0.002 0.003");
  const std::string card = "GRID           1       0      0.      1.      2.\n";
  return {
      {"\n  # VTK datafile version 3.0\nx\nASCII\n" + xyz, "VTK file (legacy .vtk)"},
      {"ASCII\nDATASET POLYDATA\nPOINTS 100 float\n" + xyz, "VTK file (legacy .vtk)"},
      {"\xef\xbb\xbf$MeshFormat\n4.1 0 8\n" + xyz, "Gmsh mesh"},
      {"Point(1) = {0, 0, 0, 0.1};\n", "Gmsh script"},
      {"View \"a\" {\nST(0,0,0,1,0,0,0,1,0){1,2,3};\n};\n", "Gmsh view"},
      {"0 3 0 0\n7 0\n" + rows(7, "3 1 2 3"), "TetGen"},
      {rows(900, "** a comment") + "*Node, nset=all\n" + nodes("", ", "), "Abaqus"},
      {"*INCLUDE, INPUT=mesh.inp\n", "Abaqus"},
      {"    1C\n    1UUSER\n" + nodes(" -1", " "), "CalculiX"},
      {rows(900, "$ a comment") + card, "Nastran"},
      {rows(900, "CTRIA3         1       1       1       2       3") + card, "Nastran"},
      {"GRID, 1, , 0.0, 1.0, 2.0\n", "Nastran"},
      {"NELEM= 7\n" + rows(7, "5 0 1 2 0") + "NDIME= 3\n" + xyz, "SU2"},
      {"# a comment\n MeshVersionFormatted 2\nDimension\n3\nVertices\n100\n" + xyz, "Medit"},
      {"\1\0\0\0\4\0\0\0\3\0\0\0"s + std::string(99, '\0'), "Medit"},
      {"# a comment\nmesh3d\ndimension\n3\npoints\n100\n" + xyz, "Netgen"},
      {"! a comment\n$ENTER COMPONENT NAME=a\n" + nodes("", " "), "PERMAS"},
      {nodes("G ", " "), "FLAC3D"},
      {"// a comment\nBegin ModelPartData\nEnd ModelPartData\n" + xyz, "Kratos"},
      {"ZONE T=\"a\", N=100, E=7\n" + xyz + rows(7, "1 2 3"), "Tecplot"},
      {"#!TDV112\1\0\0\0"s, "Tecplot"},
      {"    -1\n    58\na title\n    -1\n" + xyz, "I-DEAS"},
      {"        CONTROL INFO 2.4.6\n** GAMBIT NEUTRAL FILE\n" + nodes("", " "), "Gambit"},
      {"PROSTAR_VERTEX\n4000 0 0 0 0 0 0 0\n" + nodes("", " "), "STAR-CD"},
      {"100\n(\n" + rows(100, "(0.1 0.2 0.3)") + ")\n", "OpenFOAM"},
      {"C Binary" + std::string(72, ' ') + std::string(99, '\0'), "EnSight"},
      {"# a comment\nFORMAT\ntype:   ensight gold\n", "EnSight"},
      {"N,1,0.0,0.0,0.0\nN,2,1.0,0.0,0.0\n", "Ansys"},
      {"! a comment\n/prep7\nN,1,0,0,0\n", "Ansys"},
      {"25 0 0 1 0 0 0 0 0\na title\n26 0 0 1 100 7 1 0 0\n" + xyz, "Patran"},
      {"100 9 7 GtsSurface GtsFace GtsEdge GtsVertex\n" + xyz, "GTS"},
      {"gmvinput ascii\nnodev 100\n" + xyz, "GMV"},
      {"#RADIOSS STARTER\n/BEGIN\n/NODE\n" + nodes("", " "), "Radioss"},
      {"*filetype(ASCII)\n*node(1,0,0,0)\n", "HyperMesh"},
      {"TITRE\nx\nFINSF\nCOOR_3D\n" + nodes("N", " "), "Code_Aster"},
      {"PGEOMETRY V5\nNPoints 100 NPrims 7\n" + xyz, "Houdini"},
      {"SRID=4326;MULTIPOINT Z ((1 2 3),(4 5 6))\n", "WKT"},
      {"CDF\5\0\0\0\0"s, "NetCDF"},
      {"@(#)ADF Database Version A02011>" + std::string(9, '\0'), "CGNS"},
  };
}

std::vector<ForeignFile> more_others() {
  const std::string heights = rows(40, "0.02 0.021 0.022 0.023 0.024 0.025");
  const std::string jt = "Version 9.5 JT  DM 6.4" + std::string(99, '\0');
  return {
      {"/* a comment\nncols 6\nnrows 40\n" + heights, "ESRI grid"},
      {"xllcorner 0\nyllcorner 0\nncols 6\nnrows 40\n" + heights, "ESRI grid"},
      {"proj: 1\nzone: 0\nnorth: 1\nsouth: 0\n" + heights, "GRASS grid"},
      {"-996 40 0.1 0.1\n0 2 0 3\n6 0 0 0\n0 0 0 0 0 0 0\n" + heights, "Irap grid"},
      {"! a comment\n@GRID FILE, GRID, 4\n15, -99999.0, , 4, 1\n" + heights, "ZMap grid"},
      {"#POINTS\n6\n#ROWS\n40\n#GRID\n" + heights, "GXF grid"},
      {"ENVI\ndescription = {x}\n", "ENVI grid"},
      {"DatasetHeader Begin\n", "ER Mapper grid"},
      {"P2\n# a comment\n6 40\n255\n" + rows(40, "1 2 3 4 5 6"), "picture"},
      {"II+\0\10\0\0\0"s, "TIFF"},
      {"NDims = 3\nDimSize = 3 3 3\n", "MetaImage"},
      {"#binvox 1\ndim 3 3 3\ndata\n\0\33\1\4"s, "binvox"},
      {std::string(344, '\0') + "n+1\0"s, "NIfTI"},
      {"~Version Information\n VERS. 2.0:\n~A DEPTH GR\n" + heights, "well log"},
      {"PROJCS[\"x\",GEOGCS[\"y\"]]\n", "coordinate system"},
      {"PATCHES\n1\nPATCHS\n0.1 0.2 0.3 1\n", "PMVS"},
      {"newmtl a\nKd 0.5 0.5 0.5\n", "materials of an OBJ file"},
      {"\nCASCADE Topology V1, (c) Matra-Datavision\n", "OpenCASCADE"},
      {"**ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz****\n", "Parasolid"},
      {jt, "JT model"},
      {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"s + std::string(99, '\0'), "CAD program"},
      {"; made for a test\nN10 G0 X1 Y2 Z3\n", "G-code"},
      {"data_1ABC\nloop_\n_atom_site.id\n", "molecule (CIF)"},
      {"999\nmade for a test\n999\nand more\n  0\nSECTION\n", "DXF"},
      {"FOR4\0\0\1\0Maya"s, "Maya"},
      {"pnts\1\0\0\0"s, "3D Tiles"},
      {"{\"asset\":{\"version\":\"1.0\"},\"geometricError\":5}", "3D Tiles"},
      {"{\"type\":\"CityJSON\"}", "CityJSON"},
      {"PK\3\4........................a.usdc", "USD"},
      {"PK\3\4........................arr_0.npy", "NumPy"},
      {"<?xml version=\"1.0\"?>\n<document path=\"{projectname}.files/project.zip\"/>\n",
       "Metashape project"},
  };
}

TEST_F(OtherFormatsTest, AreNamedWithRemedy) {
  std::vector<ForeignFile> cases = meshes();
  for (auto* const list : {&others, &more_meshes, &more_others}) {
    for (ForeignFile& other : list()) cases.push_back(std::move(other));
  }
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
      "999\n" + xyz,
      "#grid of 5 mm\n" + xyz,
      "node id x y z\n1 7 0.1 0.2 0.3\n2 7 0.4 0.5 0.6\n",
      "n,e,z\n1,2,3\n2,3,4\n",
      "x,y,z,code\n1,2,3,AC1032\n2,3,4,PAR1\n",
  };
  for (const std::string& text : cases) EXPECT_GE(read(text).positions.size(), 2U) << text;
}

/// Short binary signatures, as the names of points.
TEST_F(OtherFormatsTest, TextIsNotBinary) {
  for (const char* const name : {"AC1032", "PAR1", "BZh", "MAP ", "IIx", "pnts", "VOX ", "PRC"}) {
    const std::string text = name + "x 1 2 3\n4 5 6\n"s;
    EXPECT_EQ(recognise(text, text.size()).kind, FileKind::kText) << name;
  }
}

TEST_F(OtherFormatsTest, OffWithoutKeywordIsNamed) {
  const std::string text = "4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0.5\n3 0 1 2\n3 1 3 2\n";
  const auto path = write("a.off", text);
  expect_parts(refusal(path), "an OFF file without the line OFF", "--format off");
  ReadOptions options;
  options.format = "off";
  EXPECT_EQ(read_scan(path, options).triangles.size(), 2U);
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
