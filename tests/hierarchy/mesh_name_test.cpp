#include "hierarchy/mesh_name.h"

#include <gtest/gtest.h>

namespace meshhier {
namespace {

TEST(MeshNameTest, MeshesAreKnownByTheirEndings) {
  for (const char* name : {"a.ply", "a.obj", "a.stl", "a.off", "a.gltf", "a.glb.gz", "a.PLY",
                           "a.Ply.GZ", "a.b.obj.gz", "ä ö.stl"})
    EXPECT_TRUE(is_mesh_name(name)) << name;
  for (const char* name : {"a", "a.txt", ".a.ply", ".ply", "a.ply.part", "a.ply.tmp",
                           "a.ply.crdownload", "a.ply~", "a.gz", "a.ply.bz2", "a.hier", "ply"})
    EXPECT_FALSE(is_mesh_name(name)) << name;
  EXPECT_EQ(mesh_stem("david.ply"), "david");
  EXPECT_EQ(mesh_stem("david.2.OBJ.gz"), "david.2");
  EXPECT_EQ(mesh_stem("david"), "");
  EXPECT_EQ(mesh_stem("@ply"), "");
}

}  // namespace
}  // namespace meshhier
