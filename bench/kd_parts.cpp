// kd_parts(): the build's partition stage on a mesh in memory.
#include "bench/partitioners.h"
#include "hierarchy/tree.h"
#include "partition/chunk.h"
#include "partition/top_tree.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

namespace meshhier::bench {
namespace {

/// Vertices a sweep takes at once, as a build reads them.
constexpr std::size_t kSweepBlock = mesh_io::MeshSource::kBlockSize;
/// For the selection of one median; the result does not depend on it.
constexpr std::uint64_t kSelectBytes = 64 << 20;
/// The pool's: no limit that is ever reached, as everything else is in memory as well.
constexpr auto kPoolBytes = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());

partition::TopTree top_tree(const PlainMesh& mesh, const Tree& tree, partition::Axis axis,
                            storage::ScratchFile& scratch) {
  std::vector<partition::IdPoint> sample;
  const partition::SampleIds ids(tree.vertex_count());
  for (std::uint64_t i = 0; i < ids.count(); ++i)
    sample.push_back({mesh.positions[ids[i]], static_cast<std::uint32_t>(ids[i])});
  partition::TopPlan plan = partition::plan_top(std::move(sample), tree, axis);
  if (plan.splits.empty())
    return {plan.chunks, {}};
  partition::SweepBlock swept;
  for (;;) {
    const partition::Sweep sweep(plan);
    partition::TopSelector selector(plan, tree, scratch, kSelectBytes);
    const std::span<const Vec3f> all(mesh.positions);
    for (std::size_t first = 0; first < all.size(); first += kSweepBlock) {
      const auto block = all.subspan(first, std::min(kSweepBlock, all.size() - first));
      sweep.count(block, static_cast<std::uint32_t>(first), swept);
      selector.add(swept);
    }
    std::vector<partition::SplitPlane> planes = selector.settle(plan);
    if (!planes.empty())
      return {plan.chunks, std::move(planes)};
  }
}

/// The mesh in chunks, and which vertices they hold.
struct Distributed {
  std::vector<partition::ChunkMesh> chunks;
  std::vector<std::vector<std::uint32_t>> ids;  ///< a chunk's vertices, ascending
};

Distributed distribute(const PlainMesh& mesh, const Tree& tree, const partition::TopTree& top) {
  const partition::ChunkMap map(tree, top.chunks());
  Distributed result{std::vector<partition::ChunkMesh>(map.count()),
                     std::vector<std::vector<std::uint32_t>>(map.count())};
  std::vector<std::uint32_t> rank_of(mesh.positions.size());
  for (std::uint32_t c = 0; c < map.count(); ++c)
    result.chunks[c].node = {top.chunks(), c};
  for (std::uint32_t v = 0; v < rank_of.size(); ++v) {
    const std::uint32_t c = top.chunk_of(mesh.positions[v], v);
    rank_of[v] = map.first_rank(c) + static_cast<std::uint32_t>(result.ids[c].size());
    result.ids[c].push_back(v);
    result.chunks[c].vertices.append(mesh.positions[v], {});
  }
  for (const MeshTriangle& t : mesh.triangles) {
    const partition::RankTriangle ranks{rank_of[t[0]], rank_of[t[1]], rank_of[t[2]]};
    const std::uint32_t a = map.chunk_of(ranks[0]);
    const std::uint32_t b = map.chunk_of(ranks[1]);
    const std::uint32_t c = map.chunk_of(ranks[2]);
    result.chunks[a].triangles.push_back(ranks);
    if (b != a)
      result.chunks[b].triangles.push_back(ranks);
    if (c != a && c != b)
      result.chunks[c].triangles.push_back(ranks);
  }
  return result;
}

}  // namespace

Parts kd_parts(const PlainMesh& mesh, std::uint32_t count, partition::Axis axis,
               storage::FileSystem& files) {
  check_part_count(mesh.positions.size(), count);
  const Tree tree(mesh.positions.size(), count);
  storage::MemoryPool pool(kPoolBytes);
  storage::ScratchFile scratch(files, std::filesystem::temp_directory_path() / "meshhier_compare",
                               pool);
  const Distributed distributed = distribute(mesh, tree, top_tree(mesh, tree, axis, scratch));
  Parts parts{std::vector<std::uint32_t>(mesh.positions.size()), count};
  for (std::size_t c = 0; c < distributed.chunks.size(); ++c) {
    const std::vector<PartitionId> split =
        partition::split_chunk(distributed.chunks[c], tree, axis);
    for (std::size_t i = 0; i < split.size(); ++i)
      parts.part_of[distributed.ids[c][i]] = raw(split[i]);
  }
  return parts;
}

}  // namespace meshhier::bench
