// Input of the formats that are imported, packed or not.
//
// First a byte: whether vertices are welded. The content decides which reader gets it, as in a
// build; what it becomes is read again.
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "import/import_input.h"
#include "support/memory_files.h"

#include <string>

namespace meshhier::tests::fuzz {
namespace {

/// Imports "mesh" and returns the PLY; with little memory, so that all is spooled and merged.
std::string imported(MemoryFiles& files, bool weld) {
  storage::MemoryPool pool(0);
  storage::ScratchFile scratch(files, "scratch", pool);
  importing::TemporaryFile ply(files, "imported.ply", pool.scratch_use());
  execution::NoProgress progress;
  const execution::CancelToken cancel;
  const importing::InputFiles input(files, std::filesystem::path("mesh"), weld);
  const importing::ImportFacts facts =
      importing::import_input(input, ply, {files, scratch, 1, progress, cancel});
  require(facts.files.size() == 1 && facts.files[0].bytes == files.bytes("mesh").size(),
          "the file is noted");
  if (!facts.faces)
    return files.content("imported.ply");  // unpacked, and read by nobody yet
  const auto source = mesh_io::open_mesh(files, "imported.ply");
  std::uint64_t vertices = 0;
  source->read_vertices(
      [&](const mesh_io::VertexBlock& b) { vertices += b.positions.size() + b.exact.size(); });
  const mesh_io::FaceCounts counts = source->read_triangles([](const auto&) {});
  require(vertices == source->description().vertex_count, "all vertices are there");
  require(counts.degenerate_triangles == 0, "degenerate triangles are gone");
  return files.content("imported.ply");
}

}  // namespace

void mesh(Bytes input) {
  Take take(input);
  const bool weld = take.upto<std::uint8_t>(1) != 0;
  MemoryFiles files;
  files.put("mesh", text_of(take.rest()));
  std::string first;
  const std::string message =
      refusal({ErrorCode::input}, "mesh", [&] { first = imported(files, weld); });
  require(!files.exists("imported.ply") && !files.exists("scratch"), "nothing is left behind");
  if (message.empty())
    require(imported(files, weld) == first, "the same once more");
}

}  // namespace meshhier::tests::fuzz
