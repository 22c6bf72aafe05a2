#include "bench/sample_tiles.h"

#include "partition/top_tree.h"

#include <cassert>

namespace meshhier::bench {
namespace {

/// Generated meshes hand out so many at once.
constexpr std::size_t kBlock = 65536;

Tree tree_of(std::uint64_t vertices, std::uint32_t partition_vertices) {
  return {vertices,
          static_cast<std::uint32_t>((vertices + partition_vertices - 1) / partition_vertices)};
}

}  // namespace

SampleChunk::SampleChunk(const GeneratedMesh& mesh, std::uint32_t partition_vertices)
    : tree(tree_of(mesh.content().vertex_count, partition_vertices)), map(tree, Level{0}) {
  assert(mesh.content().vertex_count <= partition::kChunkVertices);
  chunk.vertices.channels = mesh.content().attributes.channels();
  const auto channels = static_cast<std::size_t>(chunk.vertices.channels);
  mesh.visit_vertices(
      kBlock, [&](std::span<const Vec3d> positions, std::span<const float> attributes) {
        for (std::size_t i = 0; i < positions.size(); ++i)
          chunk.vertices.append(to_float(positions[i]), attributes.subspan(i * channels, channels));
      });
  mesh.visit_triangles(kBlock, [&](std::span<const MeshTriangle> triangles) {
    chunk.triangles.insert(chunk.triangles.end(), triangles.begin(), triangles.end());
  });
}

SampleTiles::SampleTiles(const SampleChunk& sample, partition::Axis axis)
    : leaves_(partition::build_leaves(sample.chunk,
                                      partition::split_chunk(sample.chunk, sample.tree, axis),
                                      sample.tree, sample.map)) {}

std::vector<GhostRef> SampleTiles::mapped(std::uint32_t partition) const {
  std::vector<GhostRef> result;
  for (const ChunkVertex& foreign : work(partition).foreign) {
    const partition::LeafPlace& place = partition::find_place(leaves_.places, foreign.local);
    result.push_back({place.partition, place.index});
  }
  return result;
}

BuildTile SampleTiles::resolved(std::uint32_t partition) const {
  BuildTile tile = cluster_simplify::resolve(work(partition), mapped(partition), false, partition);
  for (std::uint32_t neighbour = 0; neighbour < count(); ++neighbour) {
    const LeafTile& other = work(neighbour);
    Boundary boundary;
    boundary.vertices.channels = other.vertices.channels;
    boundary.vertices.append(other.vertices, 0, other.boundary_count);
    cluster_simplify::fill_ghosts(tile, neighbour, boundary);
  }
  return tile;
}

BuildTile joined_pair(const SampleTiles& tiles, std::uint32_t pair) {
  return cluster_simplify::join(tiles.resolved(2 * pair), 2 * pair, tiles.resolved(2 * pair + 1),
                                2 * pair + 1);
}

}  // namespace meshhier::bench
