// Pictures and texture coordinates for samples, made without the codecs and the kernel.
#pragma once

#include "hierarchy/published.h"
#include "tests/support/sample_hierarchy.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::tests {

/// A PNG of 8 bits a channel, of noise.
std::vector<std::byte> sample_png(std::uint32_t width, std::uint32_t height, bool alpha);
/// Returns a picture of one colour, 16 x 8 texels; half of them are transparent unless alpha is
/// opaque. Requires no alpha for jpeg.
TileImage sample_image(ImageFormat format, AlphaMode alpha = AlphaMode::opaque);

/// Gives a tile that has triangles texture coordinates: each corner takes one of up to three of its
/// vertex by a hash of its triangle, beside the normals that the tile has already. A vertex has the
/// first combination that a corner of it has, and is split for each further one.
Shading with_sample_texcoords(const PublishedTile& tile);

/// Such coordinates, and a picture of `image`'s kind.
void add_texture(PublishedTile& tile, const TileImage& image);

/// The same for a normal map, with coordinates as files have them, and tangents of both hands.
void add_normal_map(PublishedTile& tile, const TileImage& map);

/// Gives a tile with a picture a map of its coordinates, and tangents.
void add_relief(PublishedTile& tile, const TileImage& map);

/// Gives all tiles of a sample a picture, and says so in its records and its manifest. Requires a
/// layout without texture coordinates. Comes last: a tile's coordinates follow from its mesh and
/// normals.
void add_textures(Sample& sample, const TextureFormat& format = {},
                  AlphaMode alpha = AlphaMode::opaque);

}  // namespace meshhier::tests
