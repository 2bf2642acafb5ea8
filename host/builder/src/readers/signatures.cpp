#include "signatures.hpp"

#include "remedies.hpp"

namespace tactree::builder {
namespace {

using namespace std::string_view_literals;

constexpr const char* kSceneToPly = "open it in Blender and save it as glTF or PLY";
constexpr const char* kFromProgram = "export it as PLY, STL or E57 from the program that wrote it";
constexpr const char* kPointsToPly = "convert it with `pdal translate FILE scan.ply`";
constexpr const char* kArrayToPly = "write its points as rows x y z, or as PLY";
constexpr const char* kVolumeToPly = "extract its surface, for example in ParaView or 3D Slicer";
constexpr const char* kSplatToMesh =
    "give the mesh or the point cloud of the same pictures: splats lie about the surface, not on "
    "it";
constexpr const char* kPacketsToPly = "save its points as PLY or LAS in the scanner's own program";
constexpr const char* kTilesToPly =
    "export the model as glTF or PLY from the program that made the tiles";
constexpr const char* kNotAPicture = "give the scan, not a picture of it";
constexpr const char* kUnpack = "unpack it and give the scan inside";

constexpr Signature kBinary[] = {
    // pictures, video, documents
    {0, "\x89PNG"sv, "a PNG picture", kNotAPicture},
    {0, "\xff\xd8\xff"sv, "a JPEG picture", kNotAPicture},
    {0, "GIF8"sv, "a GIF picture", kNotAPicture},
    {0, "II*\0"sv, "a TIFF picture, perhaps a grid of heights", kGridToXyz},
    {0, "MM\0*"sv, "a TIFF picture, perhaps a grid of heights", kGridToXyz},
    {0, "II+\0"sv, "a TIFF picture, perhaps a grid of heights", kGridToXyz},
    {0, "MM\0+"sv, "a TIFF picture, perhaps a grid of heights", kGridToXyz},
    {8, "WEBP"sv, "a WebP picture", kNotAPicture},
    {0, "v/1\1"sv, "an OpenEXR picture", kNotAPicture},
    {0, "8BPS"sv, "a Photoshop picture", kNotAPicture},
    {0, "\0\0\0\x0cjP  "sv, "a JPEG 2000 picture", kNotAPicture},
    {4, "ftypheic"sv, "a HEIC picture", kNotAPicture},
    {4, "ftypmif1"sv, "a HEIC picture", kNotAPicture},
    {4, "ftyp"sv, "a video", "give the scan, not a video of it"},
    {8, "AVI LIST"sv, "a video", "give the scan, not a video of it"},
    {0, "NITF"sv, "a NITF picture", kNotAPicture},
    {0, "MZ\x90\0"sv, "a program", kNotAScan},
    {0, "\x7f\x45LF"sv, "a program", kNotAScan},
    {0, "SQLite format 3"sv, "a database", kNotAScan},
    // archives
    {0, "\x1f\x8b"sv, "a gzip archive", "unpack it with gunzip and give the result"},
    {0, "\x1f\x9d"sv, "an archive of compress (.Z)", "unpack it with gunzip and give the result"},
    {0, "BZh"sv, "a bzip2 archive", "unpack it with bunzip2 and give the result"},
    {0, "\xfd\x37zXZ\0"sv, "an xz archive", "unpack it with unxz and give the result"},
    {0, "\x28\xb5\x2f\xfd"sv, "a Zstandard archive", "unpack it with unzstd and give the result"},
    {0, "\x04\x22\x4d\x18"sv, "an LZ4 archive", "unpack it with unlz4 and give the result"},
    {0, "7z\xbc\xaf\x27\x1c"sv, "a 7-Zip archive", kUnpack},
    {0, "Rar!\x1a\x07"sv, "a RAR archive", kUnpack},
    {0, "MSCF\0\0\0\0"sv, "a cabinet archive", kUnpack},
    {257, "ustar"sv, "a tar archive", kUnpack},
    // meshes
    {0, "DRACO"sv, "a Draco file (.drc)", "decode it with `draco_decoder -i FILE -o scan.ply`"},
    {0, "\1\0\0\0\1\0\0\0\3\0\0\0"sv, "a Medit mesh (.meshb)", kMeshToPly},
    {0, "\1\0\0\0\2\0\0\0\3\0\0\0"sv, "a Medit mesh (.meshb)", kMeshToPly},
    {0, "\1\0\0\0\3\0\0\0\3\0\0\0"sv, "a Medit mesh (.meshb)", kMeshToPly},
    {0, "\1\0\0\0\4\0\0\0\3\0\0\0"sv, "a Medit mesh (.meshb)", kMeshToPly},
    {0, "\0\0\0\1\0\0\0\2\0\0\0\3"sv, "a Medit mesh (.meshb)", kMeshToPly},
    {0, "\xff\xff\xfe"sv, "a FreeSurfer surface", kMeshToPly},
    {0, "#!TDV"sv, "a Tecplot file (.plt)", kMeshToPly},
    {0, "C Binary"sv, "an EnSight geometry", kMeshToPly},
    {0, "Fortran Binary"sv, "an EnSight geometry", kMeshToPly},
    {0, "\x89HDF\r\n\x1a\n"sv, "an HDF5 file (CGNS, MED, XDMF data, MATLAB 7.3, ...)", kMeshToPly},
    {0, "CDF\1"sv, "a NetCDF file (Exodus, a grid, ...)", kMeshToPly},
    {0, "CDF\2"sv, "a NetCDF file (Exodus, a grid, ...)", kMeshToPly},
    {0, "CDF\5"sv, "a NetCDF file (Exodus, a grid, ...)", kMeshToPly},
    {0, "@(#)ADF Database"sv, "a CGNS file", kMeshToPly},
    {0, "OCTM"sv, "an OpenCTM mesh", kSurfaceToPly},
    {0, "U3D\0"sv, "a U3D scene", kSurfaceToPly},
    {0, "\0\0\x27\x0a"sv, "a shapefile", kSurfaceToPly},
    // scenes
    {0, "PXR-USDC"sv, "a USD scene", kSceneToPly},
    {0, "Ogawa"sv, "an Alembic scene", kSceneToPly},
    {0, "QC4DC4D6"sv, "a Cinema 4D scene", kSceneToPly},
    {8, "LXOB"sv, "a Modo scene", kSceneToPly},
    {8, "Maya"sv, "a Maya scene", kSceneToPly},
    {20, "Maya"sv, "a Maya scene", kSceneToPly},
    {0, "PMX "sv, "a PMX model", kSceneToPly},
    {0, "IDPO"sv, "a Quake model", kSceneToPly},
    {0, "\x7fNSJ"sv, "a Houdini geometry (.bgeo)", kSceneToPly},
    {0, "b3dm"sv, "a tile of 3D Tiles", kTilesToPly},
    {0, "i3dm"sv, "a tile of 3D Tiles", kTilesToPly},
    {0, "pnts"sv, "a tile of 3D Tiles", kTilesToPly},
    {0, "cmpt"sv, "a tile of 3D Tiles", kTilesToPly},
    {0, "NGSP"sv, "Gaussian splats (.spz)", kSplatToMesh},
    // point clouds
    {0, "CCB2"sv, "a CloudCompare file (.bin)", "open it in CloudCompare and save it as PLY"},
    {0, "BPF!"sv, "a BPF point cloud", kPointsToPly},
    {0, "RIEGL LMS RDB"sv, "a RIEGL point cloud (.rdbx)", kFromProgram},
    {12, "CXYZ"sv, "a TerraScan point cloud (.bin)", kPointsToPly},
    {0, "LASX"sv, "an index of a LAS file (.lax)", "give the LAS file itself"},
    {0, "\xd4\xc3\xb2\xa1"sv, "a recording of network packets (.pcap)", kPacketsToPly},
    {0, "\x4d\x3c\xb2\xa1"sv, "a recording of network packets (.pcap)", kPacketsToPly},
    {0, "\xa1\xb2\xc3\xd4"sv, "a recording of network packets (.pcap)", kPacketsToPly},
    {8, "\x4d\x3c\x2b\x1a"sv, "a recording of network packets (.pcapng)", kPacketsToPly},
    {0, "#ROSBAG"sv, "a recording of ROS", "write one of its point clouds as PCD or PLY"},
    {0, "\x89MCAP"sv, "a recording of ROS", "write one of its point clouds as PCD or PLY"},
    // grids and volumes
    {0, "DSBB"sv, "a Surfer grid (.grd)", kGridToXyz},
    {0, "DSRB"sv, "a Surfer grid (.grd)", kGridToXyz},
    {0, "binterr"sv, "a terrain file (.bt)", kGridToXyz},
    {0, "\xc3\x40"sv, "a seismic recording (SEG-Y)", kNotAScan},
    {128, "DICM"sv, "a volume (DICOM)", kVolumeToPly},
    {344, "n+1\0"sv, "a volume (NIfTI)", kVolumeToPly},
    {344, "ni1\0"sv, "a volume (NIfTI)", kVolumeToPly},
    {208, "MAP "sv, "a volume (MRC)", kVolumeToPly},
    {0, " BDV"sv, "a volume (OpenVDB)", kVolumeToPly},
    {0, "NanoVDB"sv, "a volume (NanoVDB)", kVolumeToPly},
    {0, "VOX \x96\0\0\0"sv, "a MagicaVoxel model", "export it from MagicaVoxel as PLY or OBJ"},
    {0, "VOX \xc8\0\0\0"sv, "a MagicaVoxel model", "export it from MagicaVoxel as PLY or OBJ"},
    // CAD
    {0, "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"sv,
     "a document of a CAD program, of 3ds Max, of a scanner or of Office (compound file)",
     kFromProgram},
    {0, "AutoCAD Binary DXF"sv, "a DXF drawing", kCadToStl},
    {0, "AC10"sv, "a DWG drawing", kCadToStl},
    {0, "3D Geometry File Format"sv, "a Rhino file (.3dm)", kCadToStl},
    {0, "\xff\xfe\xff\x0e"sv, "a SketchUp model (.skp)", kCadToStl},
    {0, "PS\0\0"sv, "a Parasolid model", kCadToStl},
    {0, "ACIS BinaryFile"sv, "an ACIS solid (.sab)", kCadToStl},
    {0, "ASM BinaryFile"sv, "an ACIS solid (.smb)", kCadToStl},
    {11, " JT "sv, "a JT model", kCadToStl},
    {0, "PRC"sv, "a PRC model", kCadToStl},
    {0, "V5_CFV2"sv, "a CATIA model", kCadToStl},
    // arrays
    {0, "\x93NUMPY"sv, "a NumPy array (.npy)", kArrayToPly},
    {0, "MATLAB 5.0"sv, "a MATLAB file (.mat)", kArrayToPly},
    {0, "PAR1"sv, "a Parquet table", kArrayToPly},
    {0, "ARROW1"sv, "an Arrow table", kArrayToPly},
    {0, "\x80\4\x95"sv, "a Python pickle", kArrayToPly},
    {0, "\xff\xfe"sv, "text in UTF-16", "save it as UTF-8"},
    {0, "\xfe\xff"sv, "text in UTF-16", "save it as UTF-8"},
};

constexpr Signature kFirstLine[] = {
    {0, "%PDF-"sv, "a PDF document", kNotAScan},
    {0, "{\\rtf"sv, "a document (RTF)", kNotAScan},
    {0, "version https://git-lfs"sv, "a Git LFS pointer, not the file itself",
     "fetch the file with git lfs pull"},
    {0, "ISO-10303-21"sv, "a CAD file (STEP or IFC)",
     "export it from the CAD program as STL or PLY"},
    // meshes
    {0, "# vtk DataFile"sv, "a VTK file (legacy .vtk)", kMeshToPly},
    {0, "$MeshFormat"sv, "a Gmsh mesh (.msh)", kMeshToPly},
    {0, "$NOD"sv, "a Gmsh mesh (.msh)", kMeshToPly},
    {0, "View \""sv, "a Gmsh view (.pos)", kMeshToPly},
    {0, "MeshVersionFormatted"sv, "a Medit mesh (.mesh)", kMeshToPly},
    {0, "mesh3d"sv, "a Netgen mesh (.vol)", kMeshToPly},
    {0, "# AVS"sv, "an AVS file", kMeshToPly},
    {0, "* FLAC3D"sv, "a FLAC3D grid", kMeshToPly},
    {0, "# Created by COMSOL"sv, "a COMSOL mesh (.mphtxt)", kMeshToPly},
    {0, "#!ascii version of"sv, "a FreeSurfer surface", kMeshToPly},
    {0, "CONTROL INFO"sv, "a Gambit mesh (.neu)", kMeshToPly},
    {0, "PROSTAR_"sv, "a STAR-CD mesh", kMeshToPly},
    {0, "gmvinput"sv, "a GMV mesh", kMeshToPly},
    {0, "PGEOMETRY"sv, "a Houdini geometry (.geo)", kSceneToPly},
    {0, "# AmiraMesh"sv, "an Amira mesh", kSurfaceToPly},
    {0, "# Avizo"sv, "an Avizo mesh", kSurfaceToPly},
    {0, "# HyperSurface"sv, "an Amira surface", kSurfaceToPly},
    {0, "GOCAD"sv, "a GOCAD surface", kSurfaceToPly},
    {0, "PATCHES"sv, "patches of PMVS (.patch)", "give the PLY file beside it"},
    {0, "[SBF]"sv, "the header of a CloudCompare cloud (.sbf)", kSurfaceToPly},
    {0, "# Bundle file"sv, "a Bundler reconstruction (.out)", kSurfaceToPly},
    {0, "NVM_V3"sv, "a VisualSFM reconstruction (.nvm)", kSurfaceToPly},
    // scenes and scripts
    {0, "#Inventor"sv, "an Open Inventor scene (.iv)", kSurfaceToPly},
    {0, "//Maya ASCII"sv, "a Maya scene", kSceneToPly},
    {0, "#usda"sv, "a USD scene", kSceneToPly},
    {0, "// MilkShape"sv, "a MilkShape model", kSceneToPly},
    {0, "##RenderMan"sv, "a RenderMan scene", kSceneToPly},
    {0, "nff"sv, "an NFF scene", kSceneToPly},
    // grids and volumes
    {0, "DSAA"sv, "a Surfer grid (.grd)", kGridToXyz},
    {0, "FSASCI"sv, "a CPS-3 grid", kGridToXyz},
    {0, "ENVI"sv, "the header of an ENVI grid (.hdr)", kGridToXyz},
    {0, "DatasetHeader"sv, "the header of an ER Mapper grid (.ers)", kGridToXyz},
    {0, "#?RADIANCE"sv, "a Radiance picture", kNotAPicture},
    {0, "#binvox"sv, "a voxel model (binvox)", kVolumeToPly},
    {0, "NRRD000"sv, "a volume (NRRD)", kVolumeToPly},
    {0, "ObjectType ="sv, "a volume (MetaImage)", kVolumeToPly},
    {0, "NDims ="sv, "a volume (MetaImage)", kVolumeToPly},
    // CAD
    {0, "**PARASOLID"sv, "a Parasolid model", kCadToStl},
    {0, "**ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz*"sv, "a Parasolid model",
     kCadToStl},
    {0, "DBRep_DrawableShape"sv, "an OpenCASCADE shape (.brep)", kCadToStl},
    {0, "CASCADE Topology"sv, "an OpenCASCADE shape (.brep)", kCadToStl},
    // other
    {0, "~Version"sv, "a well log (LAS of CWLS)", kNotAScan},
    {0, "PROJCS["sv, "a coordinate system (.prj)", "give the scan file beside it"},
    {0, "GEOGCS["sv, "a coordinate system (.prj)", "give the scan file beside it"},
    {0, "COMPD_CS["sv, "a coordinate system (.prj)", "give the scan file beside it"},
    {0, "PROJCRS["sv, "a coordinate system (.prj)", "give the scan file beside it"},
    {0, "@<TRIPOS>"sv, "a molecule (MOL2)", kNotAScan},
    {0, "LAMMPS"sv, "a molecule (LAMMPS)", kNotAScan},
    {0, "title="sv, "a Tecplot file", kMeshToPly},
};

constexpr Signature kAnyLine[] = {
    {0, "*filetype(ascii)"sv, "a HyperMesh file", kMeshToPly},
    {0, "*node"sv, "an Abaqus or LS-DYNA file", kMeshToPly},
    {0, "* node"sv, "an Abaqus or LS-DYNA file", kMeshToPly},
    {0, "*heading"sv, "an Abaqus or LS-DYNA file", kMeshToPly},
    {0, "*include"sv, "an Abaqus or LS-DYNA file", kMeshToPly},
    {0, "*keyword"sv, "an LS-DYNA file", kMeshToPly},
    {0, "begin bulk"sv, "a Nastran file", kMeshToPly},
    {0, "cend"sv, "a Nastran file", kMeshToPly},
    {0, "grid*"sv, "a Nastran file", kMeshToPly},
    {0, "grid,"sv, "a Nastran file", kMeshToPly},
    {0, "$nodes"sv, "a Gmsh mesh (.msh)", kMeshToPly},
    {0, "$enter component"sv, "a PERMAS mesh", kMeshToPly},
    {0, "dataset polydata"sv, "a VTK file (legacy .vtk)", kMeshToPly},
    {0, "dataset unstructured_grid"sv, "a VTK file (legacy .vtk)", kMeshToPly},
    {0, "dataset structured_"sv, "a VTK file (legacy .vtk)", kMeshToPly},
    {0, "dataset rectilinear_grid"sv, "a VTK file (legacy .vtk)", kMeshToPly},
    {0, "ndime="sv, "an SU2 mesh", kMeshToPly},
    {0, "nelem="sv, "an SU2 mesh", kMeshToPly},
    {0, "npoin="sv, "an SU2 mesh", kMeshToPly},
    {0, "meshversionformatted"sv, "a Medit mesh (.mesh)", kMeshToPly},
    {0, "begin modelpartdata"sv, "a Kratos mesh (.mdpa)", kMeshToPly},
    {0, "begin nodes"sv, "a Kratos mesh (.mdpa)", kMeshToPly},
    {0, "*gridpoints"sv, "a FLAC3D grid", kMeshToPly},
    {0, "* gridpoints"sv, "a FLAC3D grid", kMeshToPly},
    {0, "node id off"sv, "an EnSight geometry", kMeshToPly},
    {0, "node id given"sv, "an EnSight geometry", kMeshToPly},
    {0, "node id assign"sv, "an EnSight geometry", kMeshToPly},
    {0, "node id ignore"sv, "an EnSight geometry", kMeshToPly},
    {0, "nblock,"sv, "an Ansys file (.cdb)", kMeshToPly},
    {0, "/com,"sv, "an Ansys file (.cdb)", kMeshToPly},
    {0, "/prep7"sv, "an Ansys file (.cdb)", kMeshToPly},
    {0, "#radioss starter"sv, "a Radioss file (.rad)", kMeshToPly},
    {0, "coor_3d"sv, "a mesh of Code_Aster (.mail)", kMeshToPly},
    {0, "foamfile"sv, "an OpenFOAM file", kMeshToPly},
    {0, "variables="sv, "a Tecplot file", kMeshToPly},
    {0, "filetype="sv, "a Tecplot file", kMeshToPly},
    {0, "newmtl"sv, "the materials of an OBJ file (.mtl)", "give the OBJ file beside it"},
    {0, "ncols"sv, "an ESRI grid (.asc)", kGridToXyz},
    {0, "nrows"sv, "an ESRI grid (.asc)", kGridToXyz},
    {0, "xllcorner"sv, "an ESRI grid (.asc)", kGridToXyz},
    {0, "xllcenter"sv, "an ESRI grid (.asc)", kGridToXyz},
    {0, "north:"sv, "a GRASS grid", kGridToXyz},
    {0, "@grid file"sv, "a ZMap grid", kGridToXyz},
    {0, "_atom_site"sv, "a molecule (CIF)", kNotAScan},
};

constexpr Signature kXml[] = {
    {0, "<VTKFile"sv, "a VTK file (.vtu, .vtp, ...)", kMeshToPly},
    {0, "<Xdmf"sv, "an XDMF file", kMeshToPly},
    {0, "<dolfin"sv, "a DOLFIN mesh", kMeshToPly},
    {0, "<febio_spec"sv, "an FEBio model", kMeshToPly},
    {0, "<GIFTI"sv, "a GIFTI surface", kMeshToPly},
    {0, "<LandXML"sv, "a LandXML file", kSurfaceToPly},
    {0, "CityModel"sv, "a CityGML model", kSurfaceToPly},
    {0, "<ifcXML"sv, "a CAD file (IFC)", kCadToStl},
    {0, "3dmanufacturing/core"sv, "a part of a 3MF file", "give the 3MF file itself"},
    {0, "<MeshLabProject"sv, "a MeshLab project, which names scans but contains none",
     "give the files that it names"},
    {0, "{projectname}"sv, "a Metashape project, which names scans but contains none",
     "export the model or the point cloud from Metashape as PLY"},
    {0, "<robot "sv, "a robot (URDF), which names meshes but holds none",
     "give the files that it names"},
    {0, "<Error><Code>"sv, "the error message of a server",
     "download the scan again and check the result"},
    {0, "<kml"sv, "a KML file", kNotAScan},
    {0, "<gpx"sv, "a GPX file", kNotAScan},
    {0, "<svg"sv, "a drawing (SVG)", kNotAPicture},
};

}  // namespace

std::span<const Signature> binary_signatures() { return kBinary; }
std::span<const Signature> first_line_signatures() { return kFirstLine; }
std::span<const Signature> line_signatures() { return kAnyLine; }
std::span<const Signature> xml_signatures() { return kXml; }

}  // namespace tactree::builder
