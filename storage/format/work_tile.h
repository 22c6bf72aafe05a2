// Tiles under construction as bytes, for scratch space only: in this machine's byte order,
// unversioned.
#pragma once

#include "hierarchy/build_tile.h"
#include "hierarchy/shading.h"
#include "storage/format/tile_sums.h"

#include <cstddef>
#include <span>
#include <vector>

namespace meshhier::storage {

/// An encoded tile begins with so many bytes of counts, its head.
constexpr std::size_t kWorkTileHeadBytes = 28;
/// Returns the memory that triangles, their wedges and foreign corners take once a tile is decoded.
/// `head`: the first kWorkTileHeadBytes.
std::uint64_t work_triangle_bytes(std::span<const std::byte> head);
/// Returns the memory that the copies of its own places take.
std::uint64_t work_copy_bytes(std::span<const std::byte> head, int channels);

/// Adds a tile to `sums`; published it has as many ghosts as foreign corners.
void add_work_tile(std::span<const std::byte> head, TileSums& sums);

// `Corner` is ChunkVertex or FinerGhost; the bytes do not tell which. Triangles come back with
// wedges if the tile has copies or any wedge is not 0, and without any otherwise. Decoders require
// bytes of their encoder, and throw Error(internal) otherwise. All are thread-safe.
template <class Corner>
std::vector<std::byte> encode_work_tile(const WorkTile<Corner>& tile);
/// Requires bytes of encode_work_tile with the same `channels`; throws Error(internal) otherwise.
template <class Corner>
WorkTile<Corner> decode_work_tile(std::span<const std::byte> bytes, int channels);

template <class Corner>
std::vector<std::byte> encode_boundary(const WorkTile<Corner>& tile);
Boundary decode_boundary(std::span<const std::byte> bytes, int channels);

std::vector<std::byte> encode_own_shading(const OwnShading& shading);
OwnShading decode_own_shading(std::span<const std::byte> bytes);
/// An encoded shading begins with so many bytes, which tell the number of splits.
constexpr std::size_t kShadingHeadBytes = 8;
std::uint32_t encoded_split_count(std::span<const std::byte> head);
std::vector<std::byte> encode_boundary_shading(const BoundaryShading& boundary);
BoundaryShading decode_boundary_shading(std::span<const std::byte> bytes);

/// Returns no bytes if the map is empty.
std::vector<std::byte> encode_wedge_map(const WedgeMap& map);
WedgeMap decode_wedge_map(std::span<const std::byte> bytes);

std::vector<std::byte> encode_seam_strip(const SeamStrip& seam_strip);
SeamStrip decode_seam_strip(std::span<const std::byte> bytes);

/// Returns the bytes of the encoded tiles, and of their boundaries, which are encoded once more.
/// `vertex_bytes`: a position and its attributes.
double expected_work_tile_bytes(const TileSums& tiles, std::uint32_t vertex_bytes);
/// Returns the bytes of the encoded shadings of the tiles and of their boundaries, on a surface
/// without creases.
double expected_shading_bytes(const TileSums& tiles);
/// Returns the bytes of the encoded seam strips of simplified tiles, with borders as surfaces have
/// them.
double expected_seam_strip_bytes(const TileSums& tiles);
/// Returns the same where borders are far longer: foreign corners outweigh the tile.
double long_seam_strip_bytes(const TileSums& tiles);

}  // namespace meshhier::storage
