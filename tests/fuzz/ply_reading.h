// A mesh file read in every way there is.
#pragma once

#include "hierarchy/triangle.h"
#include "mesh_io/mesh_source.h"

#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::tests::fuzz {

/// All that a source hands out, or what it refuses it with.
struct PlyReading {
  std::vector<Vec3f> positions;
  std::vector<Vec3d> exact;
  std::vector<float> attributes;
  std::string vertex_refusal;

  std::vector<Triangle<std::uint32_t>> triangles;
  mesh_io::FaceCounts counts;
  std::string triangle_refusal;

  bool is_whole() const { return vertex_refusal.empty() && triangle_refusal.empty(); }
};

/// All throw Violation if a source breaks a promise of its header.
PlyReading read_as_stream(mesh_io::MeshSource& source);
/// Triangles first, vertices afterwards.
PlyReading read_as_stream_backwards(mesh_io::MeshSource& source);
/// Blocks where there are any, last to first; what remains, as a stream.
PlyReading read_in_blocks(mesh_io::MeshSource& source);

/// Bit for bit, and with the same words where something is refused if `words`.
bool is_same(const PlyReading& a, const PlyReading& b, bool words = true);

}  // namespace meshhier::tests::fuzz
