// Whole hierarchies made in code, as the published form holds them: the tests' own, slow and plain
// construction, independent of the stages.
#pragma once

#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "storage/format/tile_glb.h"
#include "support/meshes.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::tests {

struct SampleHierarchy {
  Tree tree;
  storage::TileFormat format;
  std::vector<PublishedTile> tiles;  ///< ascending by node; none for early nodes

  const PublishedTile& tile(NodeId node) const;
};

/// Ranks are the mesh's vertex numbers. A tile above the partitions contracts every two vertices of
/// its children, in order, to their mean; nothing is dropped but degenerate triangles, so that any
/// cut shows the image of the mesh under one map of vertices.
SampleHierarchy make_sample(const TestMesh& mesh, std::uint32_t partitions,
                            const storage::TileFormat& format = {});

/// The same with copies of many places, own ones and ghosts, which have attributes of their own
/// and other signs of zeros. Triangles use them; partitions also have triangles with two vertices
/// at one place.
SampleHierarchy with_copies(SampleHierarchy sample);

/// The same with computed normals. Requires a layout without normals. Comes last: a tile's shading
/// follows from its mesh.
SampleHierarchy shaded(SampleHierarchy sample);

/// The same with texture coordinates and pictures. Requires a layout without texture coordinates.
/// Comes last, behind shaded().
SampleHierarchy textured(SampleHierarchy sample, const TextureFormat& format = {},
                         AlphaMode alpha = AlphaMode::opaque);

/// The same with lit pictures, and under those of tiles above the partitions normal maps.
SampleHierarchy with_relief(SampleHierarchy sample, ImageFormat pictures, ImageFormat maps,
                            AlphaMode alpha = AlphaMode::opaque);

/// The same with its positions rounded to a lattice of so many bits over all of them.
SampleHierarchy quantized(SampleHierarchy sample, int bits);

/// The same with objects of these properties: a mesh whose layout has an object, some of whose
/// triangles then have corners of several. Comes last.
SampleHierarchy with_objects(SampleHierarchy sample, const std::vector<ObjectProperty>& properties);
/// What is known of an object there: names and texts with letters of any kind.
ObjectRow sample_object(std::uint32_t object, const std::vector<ObjectProperty>& properties);

/// Attributes of a vertex as a real input has them: unit normals, whole numbers for u8 and u16
/// colours, others in [0, 1].
std::vector<float> sample_attributes(const AttributeLayout& layout, std::uint64_t vertex);

/// Layouts of every kind of attribute, alone and together; the first has none.
std::vector<AttributeLayout> sample_layouts();
/// Those without texture coordinates.
std::vector<AttributeLayout> sample_layouts_without_texcoords();
/// Those without normals.
std::vector<AttributeLayout> sample_layouts_without_normals();

}  // namespace meshhier::tests
