// A mesh in spools, on its way from the format of its file to a PLY.
#pragma once

#include "base/vec.h"
#include "hierarchy/attributes.h"
#include "hierarchy/triangle.h"
#include "import/import_room.h"
#include "import/label_names.h"
#include "import/material_table.h"
#include "import/object_names.h"
#include "storage/io/spool.h"

#include <cstdint>
#include <memory>

namespace meshhier::importing {

/// A mesh whose vertices and triangles lie in spools, in the order in which vertices are numbered.
/// Readers append to it; welding, cropping and joining make another one of it. For one thread.
///
/// Invariant. attributes has channels() numbers a vertex, corners of triangles are below
/// vertex_count(). While files of a list are read, vertices have the channels of their own files,
/// until join_layouts() gives all of them the same.
struct RawMesh {
  explicit RawMesh(storage::ScratchFile& scratch)
      : positions(scratch, kImportSpoolBytes),
        attributes(scratch, kImportSpoolBytes),
        triangles(scratch, kImportSpoolBytes) {}

  std::uint64_t vertex_count() const { return positions.size(); }
  std::size_t channels() const { return static_cast<std::size_t>(layout.channels()); }

  AttributeLayout layout;
  MaterialTable materials;    ///< numbered as layout.material says
  AllLabelNames label_names;  ///< numbered as values of these attributes
  /// The objects of the triangles, in their order; null if there shall be none.
  std::unique_ptr<MeshObjects> objects;
  /// All coordinates are floats, or their texts say no more (DecimalNumber).
  bool fits_float = true;
  storage::RecordSpool<Vec3d> positions;
  storage::RecordSpool<float> attributes;  ///< channels() a vertex
  storage::RecordSpool<Triangle<std::uint32_t>> triangles;
};

}  // namespace meshhier::importing
