#include "bench/generator.h"

namespace meshhier::bench {
namespace {

/// The writer gets so many at once: 1.5 MiB of positions, large against a call's cost.
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

std::uint64_t write_ply(storage::FileSystem& files, const storage::OutputRequest& request,
                        const GeneratedMesh& mesh) {
  storage::OutputFile output(files, request);
  mesh_io::PlyWriter writer(output.file(), mesh.content());
  write_vertices(writer, mesh);
  mesh.visit_triangles(kWriteBlock, [&](std::span<const MeshTriangle> triangles) {
    writer.write_triangles(triangles);
  });
  writer.finish();
  const std::uint64_t bytes = output.file()->size();
  output.publish();
  return bytes;
}

}  // namespace meshhier::bench
