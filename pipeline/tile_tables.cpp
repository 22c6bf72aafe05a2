#include "pipeline/tile_tables.h"

#include "base/error.h"
#include "execution/parallel.h"
#include "storage/format/tile_object_table.h"

#include <algorithm>

namespace meshhier::pipeline {
namespace {

std::uint64_t sort_bytes(const StageContext& context) {
  constexpr std::uint64_t kMostSortBytes = std::uint64_t{64} << 20;
  return std::min(context.memory().work_bytes / 8, kMostSortBytes);
}

}  // namespace

TileTables::TileTables(const Forest& forest, std::span<const NodeId> nodes,
                       const storage::ObjectTable& table, const storage::ScratchFile& scratch,
                       std::size_t in_flight, const StageContext& context)
    : scratch_(scratch.beside("rows")),
      rows_(scratch_, sort_bytes(context)),
      properties_(table.properties()) {
  context.progress.stage("publish", nodes.size(), "tiles");
  execution::ordered_for(
      nodes.size(), in_flight, context.cancel,
      [&](std::size_t i) {
        return storage::objects_of(forest.load(nodes[i]).mesh, forest.layout(nodes[i].level));
      },
      [&](std::size_t i, const std::vector<std::uint32_t>& objects) {
        if (objects.back() >= table.size())
          throw Error(ErrorCode::corrupt, "the table of objects lacks some that triangles name");
        rows_.ask(static_cast<std::uint32_t>(i), objects);
        context.progress.advance(1);
      });
  rows_.fetch([&, cells = storage::cell_reader(table)](std::uint32_t object) {
    context.cancel.check();
    return cells(object);
  });
}

TileObjects TileTables::next() {
  storage::TileTableMaker maker(properties_);
  rows_.take(next_++, [&](std::uint32_t object, auto cells) { maker.add(object, cells); });
  return maker.take();
}

}  // namespace meshhier::pipeline
