#include "pipeline/object_stage.h"

#include "base/error.h"
#include "execution/parallel.h"
#include "hierarchy/object_parts.h"
#include "partition/object_census.h"
#include "pipeline/object_words.h"
#include "pipeline/plan/tile_room.h"
#include "storage/format/layout.h"
#include "storage/format/object_table.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace meshhier::pipeline {

storage::ObjectsSummary make_objects(Forest& forest, Vec3d origin,
                                     const std::filesystem::path& imported,
                                     const std::filesystem::path& directory,
                                     storage::ScratchFile& scratch, const StageContext& context) {
  constexpr std::uint64_t kMostSortBytes = std::uint64_t{64} << 20;
  const Tree& tree = context.tree();
  const std::vector<NodeId> nodes = tree.tile_nodes();
  context.progress.stage("objects", nodes.size(), "tiles");
  partition::ObjectCensus census(tree.depth(), scratch,
                                 std::min(context.memory().work_bytes / 4, kMostSortBytes));
  const TileRoom room = room_for(forest, context.memory(), {heaviest_read(forest, nodes)});
  execution::ordered_for(
      nodes.size(), room.in_flight(), context.cancel,
      [&](std::size_t i) {
        const NodeId node = nodes[i];
        return object_parts(tree, node, forest.load(node).mesh, forest.layout(node.level), origin);
      },
      [&](std::size_t, const std::vector<ObjectPart>& parts) {
        census.add(parts);
        context.progress.advance(1);
      });
  census.end();

  const storage::ObjectTable table(context.files.open(imported));
  context.files.make_directories(directory);  // it is the first file there
  const auto file = context.files.create(storage::objects_path(directory));
  storage::ObjectTableWriter writer(*file, table.properties());
  table.for_each([&](std::uint32_t object, ObjectRow row) {
    context.cancel.check();
    const partition::ObjectExtent extent = census.take(object);
    row.box = extent.box;
    row.triangles = extent.triangles;
    row.area = extent.area;
    writer.add(std::move(row));
  });
  if (census.next())
    throw Error(ErrorCode::corrupt, imported.string() + ": lacks objects that triangles name");
  return {writer.finish(), census.shown(), false,
          make_object_words(table, directory, scratch, context)};
}

StageTimes objects_time(const JobSize& /*job*/, const TilePopulation& tiles) {
  constexpr double kTriangleSeconds = 40e-9;
  return {{"objects", "tiles",
           static_cast<std::uint64_t>(tiles.partitions.count + tiles.simplified.count -
                                      tiles.early.count),
           (tiles.partitions.triangles + tiles.simplified.triangles) * kTriangleSeconds}};
}

}  // namespace meshhier::pipeline
