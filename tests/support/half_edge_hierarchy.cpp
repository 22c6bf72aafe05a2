#include "tests/support/half_edge_hierarchy.h"

#include "hierarchy/topology.h"
#include "mesh_io/ply_writer.h"
#include "pipeline/build.h"
#include "tests/support/quick_config.h"

#include <span>
#include <utility>

namespace meshhier::tests {
namespace {

/// A value as the colour type has them.
float colour_value(ColourType type, std::uint64_t vertex, std::uint64_t stream) {
  const float noise = hash_noise(vertex, stream);
  if (type == ColourType::f32)
    return noise;
  const float most = type == ColourType::u8 ? 255.0F : 65535.0F;
  return static_cast<float>(static_cast<std::uint32_t>((noise + 1) / 2 * most));
}

}  // namespace

AttributedMesh attributed(TestMesh shape, const AttributeLayout& layout) {
  AttributedMesh mesh{std::move(shape), layout, {}, {}};
  for (std::uint64_t v = 0; v < mesh.shape.positions.size(); ++v) {
    const auto channels = static_cast<std::uint64_t>(layout.channels());
    for (std::uint64_t stream = 0; stream < channels; ++stream) {
      const bool is_colour = layout.part(AttributeKind::colours).has(stream);
      mesh.attributes.push_back(is_colour ? colour_value(layout.colour, v, stream)
                                          : hash_noise(v, stream));
    }
  }
  return mesh;
}

AttributedMesh far_away(TestMesh shape) {
  AttributedMesh mesh{std::move(shape), {}, {}, {}};
  for (const Vec3f& p : mesh.shape.positions)
    mesh.exact.push_back(to_double(p) + Vec3d{500123.125, 5812345.5, -70.25});
  return mesh;
}

config::Config half_edge_config(const std::filesystem::path& directory, std::uint32_t partitions,
                                std::uint32_t tile_vertices) {
  config::Config config = quick_config();
  config.input = directory / "mesh.ply";
  config.output = directory / "mesh.hier";
  config.threads = 1;
  config.partition.count = partitions;
  config.topology = Topology::index;  // a stream has one vertex at a place
  config.simplify.method = config::SimplifyMethod::half_edge;
  config.simplify.vertices = tile_vertices;
  return config;
}

void build_half_edge(storage::FileSystem& files, const AttributedMesh& mesh,
                     const config::Config& config) {
  mesh_io::PlyContent content;
  content.vertex_count = mesh.shape.positions.size();
  content.triangle_count = mesh.shape.triangles.size();
  content.attributes = mesh.layout;
  content.double_coordinates = !mesh.exact.empty();
  mesh_io::PlyWriter writer(files.create(config.input.front()), content);
  if (mesh.exact.empty())
    writer.write_vertices(std::span<const Vec3f>(mesh.shape.positions), mesh.attributes);
  else
    writer.write_vertices(std::span<const Vec3d>(mesh.exact), mesh.attributes);
  writer.write_triangles(mesh.shape.triangles);
  writer.finish();
  execution::NoProgress progress;
  const execution::CancelToken cancel;
  pipeline::build_hierarchy(config, {.force = true}, {files, progress, cancel});
}

}  // namespace meshhier::tests
