// Keeps what was last made of nodes' files, as far as a limit of bytes allows.
#pragma once

#include "hierarchy/ids.h"
#include "hierarchy/published.h"

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <utility>

namespace meshhier::exporting {

inline std::uint64_t memory_bytes(const VertexArray& vertices) {
  return vertices.positions.size() * sizeof(Vec3f) + vertices.attributes.size() * sizeof(float);
}

inline std::uint64_t memory_bytes(const Shading& shading) {
  return shading.normals.size() * sizeof(NormalCode) + shading.texcoords.size() * sizeof(Vec2f) +
         shading.tangents.size() * sizeof(TangentCode) +
         shading.split_of.size() * sizeof(std::uint32_t) +
         (shading.interior.size() + shading.border.size()) * sizeof(TileTriangle);
}

/// Returns the bytes that a tile holds in memory.
inline std::uint64_t memory_bytes(const PublishedTile& tile) {
  const TileMesh& mesh = tile.mesh;
  return sizeof(PublishedTile) + memory_bytes(mesh.vertices) + memory_bytes(mesh.copies.vertices) +
         mesh.copies.size() * sizeof(std::uint32_t) + mesh.ghosts.size() * sizeof(GhostRef) +
         (mesh.interior.size() + mesh.border.size()) * sizeof(TileTriangle) +
         (mesh.interior_wedges.size() + mesh.border_wedges.size()) * sizeof(CornerWedges) +
         tile.parent_map.size() * sizeof(std::uint16_t) + memory_bytes(tile.shading) +
         tile.image.bytes.size() + tile.normal_map.bytes.size() +
         tile.chains.size() * sizeof(std::uint32_t) + tile.chains.entries().size_bytes();
}

/// Keeps values by node; the least recently used go first. The limit changes the cost of get(),
/// never its result. Not thread-safe.
template <class Value>
class NodeCache {
 public:
  using Load = std::function<Value(NodeId)>;
  using Cost = std::function<std::uint64_t(const Value&)>;

  /// `load` may throw: nothing is kept then. `cost`: bytes of a value. At least one value is kept.
  NodeCache(std::uint64_t limit_bytes, Load load, Cost cost)
      : limit_bytes_(limit_bytes), load_(std::move(load)), cost_(std::move(cost)) {}

  /// Returns the value of a node, loaded if it is not there. It stays valid as long as the pointer
  /// is held. Throws as `load`.
  std::shared_ptr<const Value> get(NodeId node) {
    if (const auto found = places_.find(node); found != places_.end()) {
      entries_.splice(entries_.begin(), entries_, found->second);
      return found->second->value;
    }
    auto value = std::make_shared<const Value>(load_(node));
    const std::uint64_t bytes = cost_(*value);
    used_bytes_ += bytes;
    entries_.push_front({node, value, bytes});
    places_[node] = entries_.begin();
    while (used_bytes_ > limit_bytes_ && entries_.size() > 1)
      drop_last();
    return value;
  }

  std::uint64_t used_bytes() const { return used_bytes_; }

 private:
  struct Entry {
    NodeId node;
    std::shared_ptr<const Value> value;
    std::uint64_t bytes = 0;
  };

  void drop_last() {
    used_bytes_ -= entries_.back().bytes;
    places_.erase(entries_.back().node);
    entries_.pop_back();
  }

  std::uint64_t limit_bytes_;
  Load load_;
  Cost cost_;
  std::uint64_t used_bytes_ = 0;
  std::list<Entry> entries_;  ///< most recently used first
  std::map<NodeId, typename std::list<Entry>::iterator> places_;
};

}  // namespace meshhier::exporting
