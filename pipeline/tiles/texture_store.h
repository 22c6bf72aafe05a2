// Pictures of the tiles under construction, in scratch space.
#pragma once

#include "hierarchy/texture.h"
#include "hierarchy/tile_mesh.h"
#include "hierarchy/tree.h"
#include "images/image.h"
#include "storage/io/blob_store.h"
#include "texture/bake.h"
#include "texture/corners.h"
#include "texture/normal_bake.h"
#include "texture/normal_texels.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// So many bytes of the input's pictures that were read are held, and as many of finer tiles'. More
/// than the most saves no time worth it.
inline constexpr std::uint64_t kLeastPictureCache = std::uint64_t{6} << 20;
inline constexpr std::uint64_t kMostPictureCache = std::uint64_t{24} << 20;

/// Returns the part of a stage's memory that is for them.
constexpr std::uint64_t picture_cache_bytes(std::uint64_t work_bytes) {
  return std::clamp(work_bytes / 16, kLeastPictureCache, kMostPictureCache);
}

/// Returns the rest, for pictures and normal maps at work.
constexpr std::uint64_t picture_room_bytes(std::uint64_t work_bytes) {
  return work_bytes - std::min(work_bytes, 2 * picture_cache_bytes(work_bytes));
}

/// The picture and the normal map that a tile is published with. Its triangles are those that
/// Forest::load() gives, interior ones first; a partition's once its vertices are ordered.
struct TileTexture {
  TileImage image;                                  ///< empty if the tile has no triangles
  std::vector<texture::CornerTexcoords> corners;    ///< one a triangle
  TileImage normal_map{};                           ///< empty if the tile has none
  std::vector<texture::CornerTangents> tangents{};  ///< with a normal map one a triangle
};

/// The surface that the pictures and normal maps of coarser tiles are made of: a tile with its
/// picture, perhaps reduced, or with its directions.
struct BakeSource {
  std::vector<Vec3f> positions;        ///< one for each place
  std::vector<std::uint16_t> parents;  ///< of own ones: the vertex that they become of the tile
                                       ///< above which is made of this source
  std::vector<TileTriangle> triangles;
  std::vector<texture::CornerTexcoords> corners;
  images::Image image;
  AlphaMode alpha = AlphaMode::opaque;
  texture::NormalTexels directions{};
  std::vector<texture::CornerNormals>
      normals{};  ///< partitions have these, no `directions`; not stored

  texture::TexturedSurface surface() const { return {positions, triangles, corners, &image}; }
  /// Returns the memory that its arrays take.
  std::uint64_t bytes() const;
};

/// The sizes of texels on the surface, in input units.
struct TexelSizes {
  float own = 0;      ///< the tile's picture
  float finest = 0;   ///< the finest of the pictures of the partitions below it
  float lost = 0;     ///< pixels of this size hardly differ from the input's (see BakedTexture)
  float degrees = 0;  ///< a normal map is off the original by so much
};

/// Holds the texture and the bake source of each tile node. Putting and loading are thread-safe for
/// different nodes; any threads may load the same one. Failures of the scratch file throw
/// Error(io), and Error(corrupt) if another process's file is not as it was.
class TextureStore {
 public:
  TextureStore(const Tree& tree, storage::ScratchFile& scratch);
  TextureStore(const TextureStore&) = delete;
  TextureStore& operator=(const TextureStore&) = delete;
  ~TextureStore() { drop_copies(); }

  /// Sets how many bytes of recently read sources stay in memory, at most.
  void set_cache_bytes(std::uint64_t bytes) { cache_bytes_ = bytes; }
  /// Writes both to disk. The source stays in memory as it is while the budget lasts.
  void put(NodeId node, const TileTexture& texture, BakeSource source, const TexelSizes& texels);
  /// Returns an empty one if none was put.
  TileTexture texture(NodeId node) const;
  std::shared_ptr<const BakeSource> source(NodeId node) const;
  /// Returns the same as it was put, past those in memory.
  BakeSource read_source(NodeId node) const;
  /// Returns a source that was never put so: makes it unless it is still in memory.
  std::shared_ptr<const BakeSource> source(NodeId node,
                                           const std::function<BakeSource()>& make) const;
  const TexelSizes& texels(NodeId node) const {
    return levels_[raw(node.level)].texels[node.index];
  }
  /// Whether any tile has one. Requires that all tiles' textures are there.
  bool has_normal_maps() const;
  /// Returns the bytes of all published pictures.
  std::uint64_t image_bytes() const;
  /// Returns the bytes of the largest texture of a tile: picture, map and corners.
  std::uint64_t heaviest_bytes() const;

  // For the journal, as Forest's.
  nlohmann::json stored(NodeId node) const;
  bool restore(NodeId node, const nlohmann::json& stored);
  void drop_copies();

 private:
  struct LevelStore {
    storage::BlobStore textures, sources;
    std::vector<TexelSizes> texels;
    std::vector<std::shared_ptr<const BakeSource>> held;  ///< sources, while the pool has room
  };
  using Key = std::pair<Level, std::uint32_t>;
  struct Cached {
    Key key;
    std::shared_ptr<const BakeSource> source;
  };

  /// Calls visit(bytes of the picture, bytes of the normal map) of each tile, until it is false.
  template <class Visit>
  void for_each_size(const Visit& visit) const;

  storage::ScratchFile& scratch_;
  std::vector<LevelStore> levels_;
  std::uint64_t cache_bytes_ = 0;
  mutable std::mutex mutex_;
  mutable std::list<Cached> cached_;  ///< the latest first
  mutable std::map<Key, std::list<Cached>::iterator> found_;
  mutable std::uint64_t cached_bytes_ = 0;
};

}  // namespace meshhier::pipeline
