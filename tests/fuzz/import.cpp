// Input of the formats that are imported, packed or not.
//
// First a byte: whether vertices are welded. The content decides which reader gets it, as in a
// build; what it becomes is read again. Pictures and a library of materials lie beside it. Of glTF
// the byte also tells whether textures are ignored; a buffer, "a.bin", and a picture, "b.png", lie
// beside it.
#include "fuzz/import_reading.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "import/import_input.h"
#include "mesh_io/ply_source.h"

#include <algorithm>
#include <memory>
#include <string>

namespace meshhier::tests::fuzz {
namespace {

/// A triangle whose buffer is in its JSON.
constexpr const char* kTile =
    R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":
[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":
"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":
"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";

constexpr const char* kLibrary =
    "newmtl m\nmap_Kd a.png\nnewmtl n\nKd 1 0 0\nnewmtl t\nmap_Kd -o 0.5 t.<UDIM>.png\n";

/// Materials of vertices are some of the list.
void check_materials(const mesh_io::VertexBlock& block, const AttributeLayout& layout,
                     std::size_t materials) {
  const auto channels = static_cast<std::size_t>(layout.channels());
  for (std::size_t i = 0; layout.material && i < block.attributes.size(); i += channels) {
    const float number = block.attributes[i + layout.part(AttributeKind::material).first];
    require(number >= 0 && number < static_cast<float>(materials) &&
                number == static_cast<float>(static_cast<std::size_t>(number)),
            "a vertex has a material of the list");
  }
}

void check(MemoryFiles& files, const importing::ImportFacts& facts) {
  const std::unique_ptr<mesh_io::MeshSource> source =
      facts.terrain
          ? importing::open_terrain(*facts.terrain)
          : mesh_io::make_ply_source(files.open("imported.ply"), {.writer = facts.writer});
  const mesh_io::MeshDescription& mesh = source->description();
  require(mesh.attributes.material == facts.textures.has_value() &&
              mesh.attributes.material == !facts.materials.empty(),
          "a textured mesh has materials");
  std::uint64_t vertices = 0;
  source->read_vertices([&](const mesh_io::VertexBlock& block) {
    vertices += block.positions.size() + block.exact.size();
    check_materials(block, mesh.attributes, facts.materials.materials.size());
  });
  const mesh_io::FaceCounts counts = source->read_triangles([](const auto&) {});
  require(vertices == mesh.vertex_count, "all vertices are there");
  require(counts.degenerate_triangles == 0, "degenerate triangles are gone");
  for (const images::ImageSource& image : facts.materials.images)
    require(image.file.empty() || files.kind(image.file) == storage::FileKind::regular,
            "pictures are there");
  for (const images::Material& material : facts.materials.materials)
    require(!material.image || *material.image < facts.materials.images.size(),
            "pictures of materials are in the list");
}

/// `named`: what a refusal tells.
void import_twice(MemoryFiles& files, bool weld, importing::Textures textures,
                  const std::string& named = "mesh") {
  std::string first;
  const std::string message = refusal({ErrorCode::input, ErrorCode::budget}, named,
                                      [&] { first = imported(files, weld, textures); });
  require(!files.exists("imported.ply") && !files.exists("scratch"), "nothing is left behind");
  if (message.empty())
    require(imported(files, weld, textures) == first, "the same once more");
}

}  // namespace

void put_pictures(MemoryFiles& files) {
  for (const char* name : {"a.png", "t.1001.png", "b/C d.png"})
    files.put(name, "a picture");
}

std::string imported(MemoryFiles& files, bool weld, importing::Textures textures) {
  return imported(files, {weld, textures});
}

std::string imported(MemoryFiles& files, const importing::InputUse& use) {
  storage::MemoryPool pool(0);
  storage::ScratchFile scratch(files, "scratch", pool);
  importing::TemporaryFile ply(files, "imported.ply", pool.scratch_use());
  execution::NoProgress progress;
  const execution::CancelToken cancel;
  importing::InputFiles input(files, std::filesystem::path("mesh"), use);
  const importing::ImportFacts facts =
      importing::import_input(input, ply, {files, scratch, 1, progress, cancel, "objects"});
  require(std::ranges::any_of(
              facts.files,
              [&](const SourceFile& file) { return file.bytes >= files.bytes("mesh").size(); }),
          "the file is noted");
  if (facts.faces || facts.terrain)  // else unpacked, and read by nobody yet
    check(files, facts);
  return facts.terrain ? "" : files.content("imported.ply");
}

void mesh(Bytes input) {
  Take take(input);
  const bool weld = take.upto<std::uint8_t>(1) != 0;
  MemoryFiles files;
  files.put("mesh", text_of(take.rest()));
  files.put("a.mtl", kLibrary);
  put_pictures(files);
  import_twice(files, weld, importing::Textures::use);
}

void gltf(Bytes input) {
  Take take(input);
  const auto flags = take.number<std::uint8_t>();
  MemoryFiles files;
  files.put("mesh", text_of(take.rest()));
  files.put("b.png", "a picture");
  std::string buffer;
  for (int i = 0; i < 1024; ++i)
    buffer.append({static_cast<char>(i % 5), 0, static_cast<char>(i % 7), 0});
  files.put("a.bin", buffer);
  import_twice(files, (flags & 1) != 0,
               (flags & 2) != 0 ? importing::Textures::ignore : importing::Textures::use);
}

void tileset(Bytes input) {
  Take take(input);
  const bool is_tile = take.upto<std::uint8_t>(1) != 0;
  MemoryFiles files;
  const std::string content(text_of(take.rest()));
  files.put("mesh", is_tile ? R"({"asset":{"version":"1.0"},"geometricError":1,"root":
{"boundingVolume":{"sphere":[0,0,0,1]},"geometricError":0,"content":{"uri":"a.b3dm"}}})"
                            : content);
  files.put("a.b3dm", is_tile ? content : std::string(kTile));
  files.put("b.json", R"({"asset":{"version":"1.0"},"geometricError":1,"root":
{"boundingVolume":{"region":[0,0,0.1,0.1,0,1]},"geometricError":0,"refine":"ADD","content":{"uri":"a.b3dm"}}})");
  import_twice(files, false, importing::Textures::use, "");
}

}  // namespace meshhier::tests::fuzz
