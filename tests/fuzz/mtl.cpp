// A material library, and what a textured mesh becomes by it.
#include "fuzz/import_reading.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"

#include <string>

namespace meshhier::tests::fuzz {
namespace {

/// Triangles with and without texture coordinates, in two squares of them, of materials of all
/// sorts of names.
constexpr const char* kMesh =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1.5 1\nvt 1.9 1\n"
    "vt 1.5 1e30\nf 1/1 2/2 3/3\nusemtl m\nf 1/1 2/2 3/3\nf 1 2 3\nf 1/4 2/5 3/6\n"
    "usemtl\nf 1/1 2/2 3/4\nusemtl a b #1\nf 1/1 2/2 3/3\nf 1/4 2/5 3/4\n";

}  // namespace

void mtl(Bytes input) {
  MemoryFiles files;
  files.put("mesh", kMesh);
  files.put("a.mtl", text_of(input));
  put_pictures(files);
  std::string first;
  const std::string message =
      refusal({ErrorCode::input}, "a.mtl", [&] { first = imported(files, false); });
  if (message.empty())
    require(imported(files, false) == first, "the same once more");
}

}  // namespace meshhier::tests::fuzz
