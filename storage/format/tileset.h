// 3D Tiles 1.1 over a hierarchy's tiles: tileset.json, and the files that it pages through.
//
// One tile of the tileset is one node; refinement replaces. A box holds all that is drawn of a node
// and below it; the geometric errors are the tiles' errors times a factor, strictly decreasing,
// because viewers allow for many pixels by default. The root's transform holds the origin: numbers
// below it are small, and floats suffice for who multiplies matrices in floats. Where a file would
// have more than kTilesetLevels levels, the nodes of the next one are external tilesets, so that a
// viewer starts with one small request and no file exceeds 256 kB.
#pragma once

#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "storage/format/manifest.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace meshhier::storage {

/// The most levels in one file: 127 nodes and 128 references, some 300 bytes each.
inline constexpr int kTilesetLevels = 7;

struct TilesetFile {
  std::filesystem::path path;  ///< relative to the hierarchy
  std::string text;
};

/// Visits every file, tileset.json first. It needs from the manifest generator, source, origin, up,
/// transform, units, licence and tileset_pixels. Deterministic, O(tiles). `records`: all of the
/// tree's, ascending by node.
void for_each_tileset(const Manifest& manifest, const Tree& tree,
                      std::span<const TileRecord> records,
                      const std::function<void(const TilesetFile&)>& visit);

/// Writes them all below `directory`, and their count, bytes and checksum into the manifest, whose
/// total_bytes grows by these bytes. Throws Error(io).
void write_tilesets(FileSystem& files, const std::filesystem::path& directory, const Tree& tree,
                    std::span<const TileRecord> records, Manifest& manifest);

/// Returns the transform that puts a model on the globe (WGS 84): its point `anchor`, in input
/// coordinates, to longitude and latitude, in degrees, and height above the ellipsoid, in metres;
/// its up axis points up, its x axis east.
Transform globe_transform(double longitude, double latitude, double height, Vec3d anchor,
                          UpAxis up);

}  // namespace meshhier::storage
