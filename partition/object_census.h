// Adds up what the triangles of all tiles tell of each object, out of core.
//
// Problem. An object lies in many tiles, and a tile has many objects; neither all objects nor all
// tiles fit in memory.
//
// Idea. Parts, one for an object of a tile, are sorted by object; then each object's come one
// after another.
//
// Cost. O(n log n) for n parts of 72 bytes, in the memory of the sort.
#pragma once

#include "base/bounds.h"
#include "hierarchy/object_parts.h"
#include "partition/external_sort.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace meshhier::partition {

/// What the partitions' triangles tell of an object.
struct ObjectExtent {
  std::optional<BoundsD> box;
  std::uint64_t triangles = 0;
  double area = 0;
};

/// For one thread. Call add() for all tiles, end(), then take() for ascending objects. The results
/// do not depend on the order of tiles.
class ObjectCensus {
 public:
  /// `depth`: the level of the partitions.
  ObjectCensus(Level depth, storage::ScratchFile& scratch, std::uint64_t memory_bytes)
      : parts_(scratch, memory_bytes), shown_(raw(depth) + std::size_t{1}) {}

  void add(std::span<const ObjectPart> parts) { parts_.add(parts); }
  void end();

  /// Returns the extent of an object, greater than the one before.
  ObjectExtent take(std::uint32_t object);
  /// Returns the next object that was not taken; none after the last.
  std::optional<std::uint32_t> next() const;
  /// Returns of each level how many objects its cut shows a triangle of, of those that were taken.
  const std::vector<std::uint64_t>& shown() const { return shown_; }

 private:
  struct Order {
    std::tuple<std::uint32_t, std::uint32_t> operator()(const ObjectPart& part) const {
      return {part.object, part.level};
    }
  };
  void move_on(std::size_t count);

  ExternalSort<ObjectPart, Order> parts_;
  std::span<const ObjectPart> block_;
  std::vector<std::uint64_t> shown_;
};

}  // namespace meshhier::partition
