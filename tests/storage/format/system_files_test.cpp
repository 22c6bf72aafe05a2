#include "storage/format/system_files.h"

#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

TEST(SystemFiles, AreKnownByTheirNames) {
  for (const char* name :
       {".DS_Store", "tiles/00/.DS_Store", "Thumbs.db", "tiles/Thumbs.db", "desktop.ini",
        ".nfs000000000123abCD00000001", "tiles/00/.nfs0a", "._hierarchy.json", "tiles/._000000.glb",
        "__MACOSX", "__MACOSX/._tiles.bin", "__MACOSX/david.hier/x", "tiles/__MACOSX/y", "@eaDir",
        "tiles/@eaDir/000000.glb@SynoEAStream", ".AppleDouble/Root", "@3dtilesIndex1@"})
    EXPECT_TRUE(is_system_file(name)) << name;
}

TEST(SystemFiles, NoOtherNameIsOne) {
  for (const char* name : {"",
                           "/",
                           "hierarchy.json",
                           "tiles",
                           "tiles/00/000000.glb",
                           ".hidden",
                           "DS_Store",
                           "tiles.DS_Store",
                           ".DS_Store2",
                           ".DS_Store/x",
                           ".nfs",
                           ".nfsx",
                           ".nfs12/x",
                           ".nfs 12",
                           "._",
                           "tiles/._",
                           "tiles/._a/b",
                           "__MACOSX2/x",
                           "a__MACOSX/x",
                           "__macosx",
                           "thumbs",
                           "tiles/@3dtilesIndex1@",
                           "@3dtilesIndex2@",
                           "..",
                           "../x"})
    EXPECT_FALSE(is_system_file(name)) << name;
}

}  // namespace
}  // namespace meshhier::storage
