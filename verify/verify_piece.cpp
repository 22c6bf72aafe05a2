#include "base/error.h"
#include "verify/verify_parts.h"

#include <set>
#include <vector>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

/// The nodes of a tile's level that it has ghosts of.
std::set<NodeId> neighbours_of(const PublishedTile& tile) {
  std::set<NodeId> nodes;
  for (const GhostRef& ghost : tile.mesh.ghosts)
    nodes.insert({tile.node.level, ghost.tile});
  return nodes;
}

/// Checks one tile; returns with how many neighbours it was compared.
std::size_t verify_with_neighbours(const VerifyJob& job, const TileRecord& record,
                                   const PublishedTile& tile, const std::set<NodeId>& inside) {
  verify_alone(job, record, tile);
  std::size_t compared = 0;
  for (const NodeId other : neighbours_of(tile)) {
    const NodeId stands_for = job.tree().tile_node(other);
    const bool is_its_turn = tile.node < other || stands_for != other;  // an early one has none
    if (!is_its_turn || !inside.contains(stands_for))
      continue;
    compare_neighbours(job, tile.node, other);
    ++compared;
  }
  return compared;
}

}  // namespace

void verify_piece(const VerifyJob& job) {
  if (!job.options.input.empty())
    throw Error(ErrorCode::usage, "a piece is verified without its input");
  const exporting::Region region = region_of(job.files, job.reader, job.options.region, job.cancel);
  std::vector<NodeId> nodes;
  for (const TileRecord& record : job.reader.records()) {
    if (region.may_show(record.node, {to_double(record.bounds.min), to_double(record.bounds.max)}))
      nodes.push_back(record.node);
  }
  if (nodes.empty())
    fail_empty(job.reader, job.options.region);
  const std::set<NodeId> inside(nodes.begin(), nodes.end());
  job.reader.will_read(nodes);
  job.progress.stage("verify", nodes.size(), "tiles");
  std::size_t compared = 0;
  for (const NodeId node : nodes) {
    job.cancel.check();
    if (const auto tile = job.tiles.find(node))
      compared += verify_with_neighbours(job, job.reader.record(node), *tile, inside);
    job.progress.advance(1);
  }
  job.checks.push_back(fmt::format(
      "{}: sizes, checksums and structure of {} of {} tiles, each simplified one compared with the "
      "image of its children, and {} pairs of neighbours with each other",
      job.options.region.name(), nodes.size() - job.tiles.unreadable_count(),
      job.reader.records().size(), compared));
}

}  // namespace meshhier::verifying
