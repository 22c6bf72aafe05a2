// Bounding volumes of tiles (OGC, 3D Tiles), as far as they tell where a tile is.
#pragma once

#include "base/vec.h"
#include "mesh_io/gltf_json.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace meshhier::mesh_io {

/// A ball around what a tile holds: all of its bounding volume lies in it.
struct TileVolume {
  Vec3d middle;
  double radius = 0;
  bool is_geocentric = false;  ///< it is in geocentric coordinates, whatever the tile's transform;
                               ///< else in the tile's
};

/// A place among implicit tiles: the level, 0 is the root, and the cell's numbers along each axis,
/// each below 2^level.
struct TileCell {
  std::uint32_t level = 0;
  std::array<std::uint64_t, 3> at{};
};

/// The numbers of a bounding volume.
class VolumeNumbers {
 public:
  /// Returns the volume of a tile; nothing if it has none of these kinds. Throws Error(input) if
  /// its numbers are none.
  static std::optional<VolumeNumbers> of(const GltfObject& tile);

  /// Returns the ball; nothing if a region reaches beyond half a turn.
  std::optional<TileVolume> ball() const;
  /// Returns the volume of an implicit tile below: regions and boxes are halved with each level, in
  /// two axes of a quadtree, in three of an octree. A sphere stays as it is.
  VolumeNumbers part(const TileCell& cell, bool is_octree) const;

 private:
  enum class Kind : std::uint8_t { region, box, sphere };
  VolumeNumbers(Kind kind, std::vector<double> numbers) : kind_(kind), n_(std::move(numbers)) {}

  Kind kind_;
  std::vector<double> n_;
};

}  // namespace meshhier::mesh_io
