// The size of a job: all that decides the costs of its stages.
#pragma once

#include "hierarchy/target_vertex_counts.h"
#include "hierarchy/texture.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace meshhier::pipeline {

/// The facts that decide the needs of a build.
struct JobSize {
  std::uint64_t vertex_count = 0;
  std::uint64_t place_count = 0;  ///< different positions of vertices, which the tree counts
  std::uint64_t face_count = 0;
  int channels = 0;                  ///< attribute floats per vertex
  bool computes_normals = false;     ///< tiles get normals, which the mesh does not have
  std::uint64_t held_bytes = 0;      ///< memory that the input's reader has
  std::uint64_t imported_bytes = 0;  ///< size of the PLY that the input was imported to, if it was
  bool vertices_in_place = true;     ///< else the vertices are spooled once more
  bool wide_coordinates = false;     ///< spooled as doubles
  std::uint32_t partition_count = 0;
  std::uint32_t largest_tile = 0;  ///< places of the largest partition or simplified mesh
  std::size_t threads = 1;
  TargetVertexCounts target_vertex_counts;      ///< for simplified tiles
  bool clustered = false;                       ///< simplified by the method `cluster`
  std::uint64_t published_attribute_bytes = 0;  ///< a vertex's, in a published tile
  double published_ratio = 1;                   ///< bytes of published tiles / plain ones, about
  bool packed = false;                          ///< published files become one archive
  bool textured = false;
  TextureFormat pictures;               ///< the tiles'
  AlphaMode alpha = AlphaMode::opaque;  ///< the strongest of the materials
  std::uint32_t picture_side = 0;       ///< a simplified tile's, texels at most
  std::uint64_t source_texels = 0;      ///< all pictures of the input
  std::uint64_t picture_bytes = 0;      ///< scratch space that these take, decoded
  std::uint64_t decoder_bytes = 0;      ///< memory to decode the hungriest of them
  std::uint64_t adding_bytes = 0;       ///< memory to store the widest of them
  /// A simplified tile's, texels at most; 0: there are none. The picture's side if it has one.
  std::uint32_t normal_map_side = 0;
  int unmapped_levels = 0;  ///< simplified ones next to the partitions that get no maps
  ImageFormat normal_map_format = ImageFormat::jpeg;
  bool draws_preview = false;
  std::uint32_t outline_sectors = 0;
  bool has_map = false;                  ///< PROJ places the model
  bool has_objects = false;              ///< triangles belong to objects
  bool has_object_tables = false;        ///< tiles have tables of theirs
  std::uint64_t object_table_bytes = 0;  ///< of the table that the import has left

  /// Whether simplified tiles get normal maps under their pictures.
  bool has_relief() const { return textured && normal_map_side > 0; }

  /// Returns how many vertices each place has beside its first one, on average.
  double copies_per_place() const {
    return static_cast<double>(vertex_count - place_count) / static_cast<double>(place_count);
  }
  bool has_copies() const { return place_count < vertex_count; }
  /// Returns the copies that so many places of the mesh have on average, and half as many again for
  /// those that have more.
  std::uint64_t part_copies(std::uint64_t places) const {
    return static_cast<std::uint64_t>(static_cast<double>(places) * copies_per_place() * 1.5);
  }

  /// Returns the bytes of a vertex at work: its position and its attributes, as floats.
  std::uint32_t vertex_bytes() const { return 12 + 4 * static_cast<std::uint32_t>(channels); }

  /// Returns the most triangles that name copies, if vertices have six each.
  std::uint64_t wedged_triangles() const {
    return std::min(face_count, 6 * (vertex_count - place_count));
  }

  /// Returns the most triangles of a part of the mesh with so many places, where the mesh is as
  /// dense as on average: 2 a place on closed surfaces, less on open ones; half as many again for
  /// those that several parts share.
  std::uint64_t part_triangles(std::uint64_t places) const {
    return places * std::max<std::uint64_t>(3, face_count * 3 / 2 / place_count + 1);
  }
};

}  // namespace meshhier::pipeline
