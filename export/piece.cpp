#include "export/piece.h"

#include "base/bounds.h"
#include "base/error.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace meshhier::exporting {
namespace {

/// A place in a map, beside its key.
constexpr std::uint64_t kEntryBytes = 80;

BoundsD box_of(const TileRecord& record, double margin) {
  const Vec3d more{margin, margin, margin};
  return {to_double(record.bounds.min) - more, to_double(record.bounds.max) + more};
}

bool overlap(const BoundsD& a, const BoundsD& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y &&
         a.min.z <= b.max.z && b.min.z <= a.max.z;
}

}  // namespace

std::vector<std::size_t> tiles_in(const storage::HierarchyReader& reader, const Cut& cut,
                                  const Region& region) {
  std::vector<std::size_t> inside;
  std::vector<const TileRecord*> coarse;
  Level finest{};
  for (const NodeId node : cut.nodes())
    finest = std::max(finest, reader.record(node).node.level);
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const TileRecord& record = reader.record(cut[i]);
    if (!region.may_show(cut[i], box_of(record, 0)))
      continue;
    inside.push_back(i);
    if (record.node.level < finest)
      coarse.push_back(&record);
  }
  const auto is_beside = [&](const TileRecord& record) {
    return std::ranges::any_of(coarse, [&](const TileRecord* other) {
      return other->node.level < record.node.level &&
             overlap(box_of(record, record.bound), box_of(*other, other->bound));
    });
  };
  std::vector<std::size_t> all;
  auto next = inside.begin();
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const bool is_inside = next != inside.end() && *next == i;
    next += is_inside ? 1 : 0;
    const bool may_have = !region.objects || region.objects->may_show(cut[i]);
    if (is_inside || (may_have && is_beside(reader.record(cut[i]))))
      all.push_back(i);
  }
  return all;
}

Piece::Piece(const storage::HierarchyReader& reader, Cut cut, Region region, Clipping clipping,
             std::uint64_t cache_bytes)
    : reader_(reader),
      parts_(std::in_place, reader, std::move(cut), cache_bytes),
      region_(std::move(region)),
      clipping_(clipping),
      positions_(tiles_in(reader, parts_->cut(), region_)) {
  std::vector<NodeId> nodes;
  for (const std::size_t position : positions_)
    nodes.push_back(parts_->cut()[position]);
  reader_.will_read(nodes);
}

Piece::Piece(const storage::HierarchyReader& reader, NodeId node, Region region, Clipping clipping)
    : reader_(reader),
      node_(node),
      region_(std::move(region)),
      clipping_(clipping),
      positions_{0} {}

CutPart Piece::load(std::size_t i) {
  return clip_part(parts_ ? parts_->load(positions_[i]) : part_of_tile(reader_.read_tile(node_)),
                   reader_.tile_format().attributes, region_, clipping_);
}

PieceNumbers::Numbered PieceNumbers::add(const Piece& piece, std::size_t i, const CutPart& part) {
  Numbers own;
  Numbered made;
  for (std::size_t v = 0; v < part.vertices.size(); ++v) {
    const std::uint32_t place = part.places[v];
    const std::span<const float> attributes = part.vertices.attributes_of(v);
    const Vec3f position = place == kNoPlace ? part.vertices.positions[v] : Vec3f{};
    std::string key(sizeof(place) + sizeof(position) + attributes.size_bytes(), '\0');
    std::memcpy(key.data(), &place, sizeof(place));
    std::memcpy(key.data() + sizeof(place), &position, sizeof(position));
    if (!attributes.empty())
      std::memcpy(key.data() + sizeof(place) + sizeof(position), attributes.data(),
                  attributes.size_bytes());
    const bool is_shared = piece.is_shared(i, place);
    const std::uint64_t bytes = key.size() + kEntryBytes;
    const auto [found, is_new] =
        (is_shared ? shared_ : own).try_emplace(std::move(key), static_cast<std::uint32_t>(count_));
    made.numbers.push_back(found->second);
    if (!is_new)
      continue;
    made.fresh.push_back(static_cast<std::uint32_t>(v));
    bytes_ += is_shared ? bytes : 0;
    if (++count_ > std::numeric_limits<std::uint32_t>::max())
      throw Error(ErrorCode::usage, "the piece has 2^32 vertices or more: export a smaller one");
  }
  if (bytes_ > most_bytes_) {
    throw Error(ErrorCode::budget,
                "the vertices at the borders of the tiles there exceed the memory budget: give "
                "more, export a smaller piece or a coarser level");
  }
  return made;
}

}  // namespace meshhier::exporting
