#include "pipeline/object_stage.h"

#include "base/bounds.h"
#include "base/error.h"
#include "execution/parallel.h"
#include "hierarchy/drawing_rule.h"
#include "hierarchy/value_channels.h"
#include "hierarchy/vertex_numbers.h"
#include "partition/external_sort.h"
#include "pipeline/plan/tile_room.h"
#include "storage/format/layout.h"
#include "storage/format/object_table.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace meshhier::pipeline {
namespace {

/// What the triangles of one tile tell of an object.
struct ObjectPart {
  std::uint32_t object = 0;
  std::uint32_t level = 0;
  std::uint32_t first_level = 0;  ///< cuts of the levels from here to `level` show the tile
  std::uint32_t triangles = 0;
  double area = 0;
  BoundsD box;  ///< in the input's coordinates
};
static_assert(sizeof(ObjectPart) == 72);

struct PartOrder {
  std::tuple<std::uint32_t, std::uint32_t> operator()(const ObjectPart& part) const {
    return {part.object, part.level};
  }
};
using PartSort = partition::ExternalSort<ObjectPart, PartOrder>;

/// The coarsest level whose cut shows a tile: partitions stand for early nodes.
std::uint32_t first_level(const Tree& tree, NodeId node) {
  while (raw(node.level) > 0 && tree.is_partition(node) && tree.is_early(tree.parent(node)))
    node = tree.parent(node);
  while (raw(node.level) > 0 && tree.is_early(node) && tree.is_early(tree.parent(node)))
    node = tree.parent(node);
  return static_cast<std::uint32_t>(raw(node.level));
}

/// The triangles of a tile by their objects.
class TileParts {
 public:
  TileParts(const TileMesh& mesh, const PlacedValue& object, Vec3d origin)
      : mesh_(mesh), object_(object), origin_(origin) {}

  void add(const TileTriangle& triangle) {
    ObjectPart& part = parts_[object_of(raw(triangle[0]))];
    std::array<Vec3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = to_double(position_of(raw(triangle[k]))) + origin_;
      part.box.add(corners[k]);
    }
    part.area += length(cross(corners[1] - corners[0], corners[2] - corners[0])) / 2;
    ++part.triangles;
  }

  /// Ascending by object.
  const std::map<std::uint32_t, ObjectPart>& parts() const { return parts_; }

 private:
  std::size_t places() const { return mesh_.vertices.size(); }
  Vec3f position_of(std::uint32_t vertex) const {
    return vertex < places() ? mesh_.vertices.positions[vertex]
                             : mesh_.copies.vertices.positions[vertex - places()];
  }
  std::uint32_t object_of(std::uint32_t vertex) const {
    const auto channels = vertex < places()
                              ? mesh_.vertices.attributes_of(vertex)
                              : mesh_.copies.vertices.attributes_of(vertex - places());
    return static_cast<std::uint32_t>(
        value_in(object_.type, channels.data() + object_.channel));
  }

  const TileMesh& mesh_;
  PlacedValue object_;
  Vec3d origin_;
  std::map<std::uint32_t, ObjectPart> parts_;
};

/// The objects of the triangles that a tile draws in the cut of its own level.
std::vector<ObjectPart> parts_of(const Forest& forest, NodeId node, Vec3d origin) {
  const Tree& tree = forest.tree();
  const TileMesh mesh = forest.load(node).mesh;
  const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()),
                              mesh.copies.places);
  TileParts parts(mesh, placed_object(forest.layout(node.level)).value(), origin);
  for (const TileTriangle& triangle : numbers.numbered(mesh.interior, mesh.interior_wedges))
    parts.add(triangle);
  const std::vector<TileTriangle> border = numbers.numbered(mesh.border, mesh.border_wedges);
  for (std::size_t i = 0; i < border.size(); ++i) {
    if (draws(mesh, mesh.border[i], [&](std::size_t ghost) {
          return draws_before(tree, node, mesh.ghosts[ghost].tile);
        }))
      parts.add(border[i]);
  }
  std::vector<ObjectPart> all;
  for (auto [object, part] : parts.parts()) {
    part.object = object;
    part.level = static_cast<std::uint32_t>(raw(node.level));
    part.first_level = first_level(tree, node);
    all.push_back(part);
  }
  return all;
}

/// Reads sorted parts, object after object.
class PartCursor {
 public:
  explicit PartCursor(PartSort& sorted) : sorted_(sorted) { move_on(0); }

  /// Returns the next part of the object; none if it has no more, or another one is next.
  std::optional<ObjectPart> next_of(std::uint32_t object) {
    if (block_.empty() || block_[0].object != object)
      return std::nullopt;
    const ObjectPart part = block_[0];
    move_on(1);
    return part;
  }
  bool is_at_end() const { return block_.empty(); }

 private:
  void move_on(std::size_t count) {
    block_ = block_.subspan(count);
    if (block_.empty())
      block_ = sorted_.next_block();
  }

  PartSort& sorted_;
  std::span<const ObjectPart> block_;
};

/// Adds to `row` what the partitions tell, and counts the levels that show the object.
void complete(ObjectRow& row, std::uint32_t object, std::uint32_t depth, PartCursor& parts,
              std::vector<std::uint64_t>& shown) {
  std::vector<bool> is_shown(shown.size());
  while (const auto part = parts.next_of(object)) {
    for (std::uint32_t level = part->first_level; level <= part->level; ++level)
      is_shown[level] = true;
    if (part->level != depth)
      continue;
    if (!row.box)
      row.box.emplace();
    row.box->add(part->box);
    row.triangles += part->triangles;
    row.area += part->area;
  }
  for (std::size_t level = 0; level < shown.size(); ++level)
    shown[level] += is_shown[level] ? 1 : 0;
}

}  // namespace

storage::ObjectsSummary make_objects(Forest& forest, Vec3d origin, const std::filesystem::path& imported,
                            const std::filesystem::path& directory, storage::ScratchFile& scratch,
                            const StageContext& context) {
  constexpr std::uint64_t kMostSortBytes = std::uint64_t{64} << 20;
  const Tree& tree = context.tree();
  const std::vector<NodeId> nodes = tree.tile_nodes();
  context.progress.stage("objects", nodes.size(), "tiles");
  PartSort sorted(scratch, std::min(context.memory().work_bytes / 4, kMostSortBytes));
  const TileRoom room = room_for(forest, context.memory(), {heaviest_read(forest, nodes)});
  execution::ordered_for(
      nodes.size(), room.in_flight(), context.cancel,
      [&](std::size_t i) { return parts_of(forest, nodes[i], origin); },
      [&](std::size_t, const std::vector<ObjectPart>& parts) {
        sorted.add(parts);
        context.progress.advance(1);
      });
  sorted.sort();

  const storage::ObjectTable table(context.files.open(imported));
  const auto file = context.files.create(storage::objects_path(directory));
  storage::ObjectTableWriter writer(*file, table.properties());
  PartCursor parts(sorted);
  const auto depth = static_cast<std::uint32_t>(raw(tree.depth()));
  storage::ObjectsSummary summary;
  summary.shown.resize(depth + 1);
  table.for_each([&](std::uint32_t object, ObjectRow row) {
    context.cancel.check();
    complete(row, object, depth, parts, summary.shown);
    writer.add(std::move(row));
  });
  if (!parts.is_at_end())
    throw Error(ErrorCode::corrupt, imported.string() + ": lacks objects that triangles name");
  summary.table = writer.finish();
  return summary;
}

StageTimes objects_time(const JobSize& job, const TilePopulation& tiles) {
  constexpr double kTriangleSeconds = 40e-9;
  static_cast<void>(job);
  return {{"objects", "tiles",
           static_cast<std::uint64_t>(tiles.partitions.count + tiles.simplified.count -
                                      tiles.early.count),
           (tiles.partitions.triangles + tiles.simplified.triangles) * kTriangleSeconds}};
}

}  // namespace meshhier::pipeline
