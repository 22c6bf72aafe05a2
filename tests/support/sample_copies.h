// Copies for samples: seams where the corners of one place differ in their attributes.
#pragma once

#include "tests/support/sample_hierarchy.h"

#include <filesystem>
#include <vector>

namespace meshhier::tests {

/// The content of the partitions of a sample with copies, as one mesh.
struct WedgedInput {
  TestMesh mesh;
  std::vector<float> attributes;  ///< as the sample's
};

struct CopiesOptions {
  bool equal = false;  ///< a place's vertices do not differ
  bool flat = false;   ///< partitions get triangles with a place twice
};

/// Splits the places of all tiles into up to three vertices, triangle by triangle, by a hash of the
/// triangle's corners, and makes records and manifest right again. Requires a tree without early
/// nodes: a power of two partitions.
WedgedInput add_copies(Sample& sample, const CopiesOptions& options = {});

/// Writes it as a PLY, which becomes the sample's source.
void write_input(const WedgedInput& input, Sample& sample, const std::filesystem::path& path);

}  // namespace meshhier::tests
