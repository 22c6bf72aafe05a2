// Writes a binary little endian PLY as a stream.
#pragma once

#include "base/vec.h"
#include "hierarchy/attributes.h"
#include "hierarchy/triangle.h"
#include "storage/io/file.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

struct PlyContent {
  std::uint64_t vertex_count = 0;  ///< < 2^32
  std::uint64_t triangle_count = 0;
  std::uint64_t edge_count = 0;  ///< 0: no edge element
  AttributeLayout attributes;
  bool is_import = false;  ///< values are written with their imported_prefix()
  bool double_coordinates = false;
  std::vector<std::string> comments;  ///< one line each
};

/// Takes vertices, then triangles, then edges, in the declared numbers, each in as many calls as
/// one likes, and writes the file from its first byte to its last. Colours are written in their
/// stored type (attributes.h) by their imported_colour_names() (ply_plan.h), materials as `float
/// material`, indices as `int` (`uint` from 2^31 vertices on). Buffered: at most 1 MiB. Throws
/// Error(io). finish() is required and asserts that all declared content came; without it the file
/// is incomplete. For one thread.
class PlyWriter {
 public:
  PlyWriter(std::shared_ptr<storage::File> file, const PlyContent& content);
  ~PlyWriter();

  /// `attributes`: content.attributes.channels() floats a vertex.
  void write_vertices(std::span<const Vec3f> positions, std::span<const float> attributes);
  void write_vertices(std::span<const Vec3d> positions, std::span<const float> attributes);
  void write_triangles(std::span<const Triangle<std::uint32_t>> triangles);
  void write_edges(std::span<const std::array<std::uint32_t, 2>> edges);
  /// Flushes; the file is complete after it, and not synced.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace meshhier::mesh_io
