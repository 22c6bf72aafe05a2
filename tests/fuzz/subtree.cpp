// A subtree of implicit tiles.
//
// First a byte: whether the tree is an octree, and the levels of a subtree. Each subtree of the
// tileset is the same file, so that what it says of its children is followed.
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "mesh_io/tileset.h"
#include "support/memory_files.h"

#include <cstdint>
#include <string>

#include <fmt/format.h>

namespace meshhier::tests::fuzz {
namespace {

std::string tileset_text(bool is_octree, int levels) {
  return fmt::format(
      R"({{"asset":{{"version":"1.1"}},"geometricError":1,"root":{{"boundingVolume":{{"box":
[0,0,0,1,0,0,0,1,0,0,0,1]}},"geometricError":1,"refine":"ADD","contents":[{{"uri":"a.glb"}},{{"uri":
"a.glb?{{level}}"}}],"implicitTiling":{{"subdivisionScheme":"{}","subtreeLevels":{},"availableLevels":4,
"subtrees":{{"uri":"s?{{x}}"}}}}}}}})",
      is_octree ? "OCTREE" : "QUADTREE", levels);
}

/// An empty GLB.
constexpr std::string_view kEmptyGlb{
    "glTF\2\0\0\0\x30\0\0\0\x1c\0\0\0JSON"
    R"({"asset":{"version":"2.0"}} )",
    48};

}  // namespace

void subtree(Bytes input) {
  Take take(input);
  const auto flags = take.number<std::uint8_t>();
  const int levels = 1 + (flags >> 1) % 3;
  MemoryFiles files;
  files.put("t.json", tileset_text((flags & 1) != 0, levels));
  files.put("s", std::string(text_of(take.rest())));
  files.put("b.bin", std::string(1024, '\x55'));
  files.put("a.glb", std::string(kEmptyGlb));
  refusal({ErrorCode::input, ErrorCode::budget}, "", [&] {
    const mesh_io::Tileset found = mesh_io::read_tileset(files, "t.json", nullptr, {});
    require(found.meshes.size() <= 2 * 4681, "no more than there is room for");
    require(!found.documents.empty(), "the subtree is noted");
  });
}

}  // namespace meshhier::tests::fuzz
