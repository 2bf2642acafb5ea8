// FBX: skins in the pose of the file.

#include "test_files.hpp"

namespace tactree::builder {
namespace {

/// A triangle whose points all belong to one bone at x = 10, which was bound at 0.
constexpr const char* kFbxHead = R"(; FBX 7.3.0 project file
FBXHeaderExtension:  {
	FBXHeaderVersion: 1003
	FBXVersion: 7300
}
GlobalSettings:  {
	Version: 1000
	Properties70:  {
		P: "UnitScaleFactor", "double", "Number", "",1
	}
}
Objects:  {
	Geometry: 1001, "Geometry::g", "Mesh" {
		Vertices: *9 {
			a: 0,0,0,1,0,0,0,2,0
		}
		PolygonVertexIndex: *3 {
			a: 0,1,-3
		}
		GeometryVersion: 124
	}
	Model: 1002, "Model::m", "Mesh" {
		Version: 232
		Properties70:  {
)";

constexpr const char* kFbxTail = R"(
		}
	}
	Deformer: 2001, "Deformer::", "Skin" {
		Version: 101
	}
	Deformer: 2002, "SubDeformer::", "Cluster" {
		Version: 100
		Indexes: *3 {
			a: 0,1,2
		}
		Weights: *3 {
			a: 1,1,1
		}
		Transform: *16 {
			a: 1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1
		}
		TransformLink: *16 {
			a: 1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1
		}
	}
	NodeAttribute: 2003, "NodeAttribute::", "LimbNode" {
		TypeFlags: "Skeleton"
	}
	Model: 2004, "Model::bone", "LimbNode" {
		Version: 232
		Properties70:  {
			P: "Lcl Translation", "Lcl Translation", "", "A",10,0,0
		}
	}
}
Connections:  {
	C: "OO",2004,0
	C: "OO",2003,2004
	C: "OO",2001,1001
	C: "OO",2002,2001
	C: "OO",2004,2002
	C: "OO",1002,0
	C: "OO",1001,1002
}
)";

/// With properties of the mesh.
std::string fbx(const std::string& properties) { return kFbxHead + properties + kFbxTail; }

class Fbx : public TestFiles {};

TEST_F(Fbx, PosesSkinsByTheirBones) {
  const Scan scan = read(fbx(""));
  EXPECT_EQ(scan.unit_m, 0.01);
  ASSERT_EQ(scan.positions.size(), 3U);
  EXPECT_LT((scan.positions[1] - Eigen::Vector3d(11, 0, 0)).norm(), 1e-6);
  EXPECT_TRUE(scan.warnings.empty());
}

TEST_F(Fbx, NamesSkinsWithGeometricTransform) {
  const Scan scan =
      read(fbx("P: \"GeometricTranslation\", \"Vector3D\", \"Vector\", \"\",0,0,1000"));
  EXPECT_EQ(scan.positions.size(), 3U);
  expect_parts(scan.warnings.at(0), "geometric transform, which is not applied");
}

}  // namespace
}  // namespace tactree::builder
