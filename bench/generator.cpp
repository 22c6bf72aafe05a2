#include "bench/generator.h"

#include <utility>

namespace meshhier::bench {
namespace {

/// What is handed to the writer at once: 1.5 MiB of positions, large against a call's cost.
constexpr std::size_t kWriteBlock = 65536;

void write_vertices(mesh_io::PlyWriter& writer, const GeneratedMesh& mesh) {
  std::vector<Vec3f> narrow;
  mesh.visit_vertices(kWriteBlock,
                      [&](std::span<const Vec3d> positions, std::span<const float> attributes) {
                        if (mesh.content().double_coordinates) {
                          writer.write_vertices(positions, attributes);
                          return;
                        }
                        narrow.clear();
                        for (const Vec3d p : positions)
                          narrow.push_back(to_float(p));
                        writer.write_vertices(std::span<const Vec3f>(narrow), attributes);
                      });
}

/// Removes the temporary file unless it was renamed.
class PartialFile {
 public:
  PartialFile(storage::FileSystem& files, const std::filesystem::path& path)
      : files_(files), path_(path), partial_(path) {
    partial_ += ".part";
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile() {
    if (published_)
      return;
    try {
      files_.remove_all(partial_);
    } catch (...) {  // The failure that brought us here is the one to tell.
    }
  }

  const std::filesystem::path& path() const { return partial_; }
  void publish() {
    files_.rename(partial_, path_);
    published_ = true;
  }

 private:
  storage::FileSystem& files_;
  std::filesystem::path path_;
  std::filesystem::path partial_;
  bool published_ = false;
};

}  // namespace

LoadedMesh load_mesh(mesh_io::MeshSource& source) {
  const mesh_io::MeshDescription& description = source.description();
  LoadedMesh mesh;
  mesh.attributes = description.attributes;
  mesh.double_coordinates = description.wide_coordinates;
  source.read_vertices([&](const mesh_io::VertexBlock& block) {
    for (const Vec3f p : block.positions)
      mesh.positions.push_back(to_double(p));
    mesh.positions.insert(mesh.positions.end(), block.exact.begin(), block.exact.end());
    mesh.channels.insert(mesh.channels.end(), block.attributes.begin(), block.attributes.end());
  });
  source.read_triangles([&](std::span<const Triangle<VertexId>> block) {
    for (const Triangle<VertexId>& t : block)
      mesh.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
  });
  return mesh;
}

void write_ply(storage::FileSystem& files, const std::filesystem::path& path,
               const GeneratedMesh& mesh) {
  PartialFile partial(files, path);
  {
    mesh_io::PlyWriter writer(files, partial.path(), mesh.content());
    write_vertices(writer, mesh);
    mesh.visit_triangles(kWriteBlock, [&](std::span<const MeshTriangle> triangles) {
      writer.write_triangles(triangles);
    });
    writer.finish();
  }
  partial.publish();
}

}  // namespace meshhier::bench
