// Small hierarchies that progressive streams can be made of, in memory or on a disk.
#pragma once

#include "config/config.h"
#include "hierarchy/attributes.h"
#include "progressive/stream.h"
#include "storage/io/file.h"
#include "tests/support/meshes.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace meshhier::tests {

/// A mesh and what its vertices carry.
struct AttributedMesh {
  TestMesh shape;
  AttributeLayout layout;
  std::vector<float> attributes;  ///< layout.channels() a vertex
  std::vector<Vec3d> exact;       ///< places that floats do not hold; empty: those of the shape
};

/// Attributes that are a function of a vertex's number: no two alike.
AttributedMesh attributed(TestMesh shape, const AttributeLayout& layout);

/// Places far from the origin, in doubles.
AttributedMesh far_away(TestMesh shape);

/// Contracted by half_edge, to `tile_vertices` a tile.
config::Config half_edge_config(const std::filesystem::path& directory, std::uint32_t partitions,
                                std::uint32_t tile_vertices);

/// Writes config.input and builds config.output, which it replaces. Throws what the build throws.
void build_half_edge(storage::FileSystem& files, const AttributedMesh& mesh,
                     const config::Config& config);

}  // namespace meshhier::tests
