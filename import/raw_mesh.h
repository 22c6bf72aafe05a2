// A mesh in spools, on its way from the format of its file to a PLY.
#pragma once

#include "execution/cancel.h"
#include "hierarchy/attributes.h"
#include "hierarchy/triangle.h"
#include "hierarchy/vec.h"
#include "import/label_names.h"
#include "import/material_table.h"
#include "storage/io/spool.h"

#include <cstdint>

namespace meshhier::importing {

/// Blocks of the import's spools: large writes, but small beside the least budget.
inline constexpr std::size_t kImportSpoolBytes = std::size_t{1} << 18;

struct RawMesh {
  explicit RawMesh(storage::ScratchFile& scratch)
      : positions(scratch, kImportSpoolBytes),
        attributes(scratch, kImportSpoolBytes),
        triangles(scratch, kImportSpoolBytes) {}

  std::uint64_t vertex_count() const { return positions.size(); }
  std::size_t channels() const { return static_cast<std::size_t>(layout.channels()); }

  AttributeLayout layout;
  MaterialTable materials;    ///< numbered as layout.material has them
  AllLabelNames label_names;  ///< numbered as values of these attributes
  bool fits_float = true;     ///< all coordinates do, or their texts (mesh_io::DecimalNumber)
  storage::RecordSpool<Vec3d> positions;
  storage::RecordSpool<float> attributes;  ///< channels() a vertex
  storage::RecordSpool<Triangle<std::uint32_t>> triangles;
};

/// What an import works with.
struct ImportRoom {
  storage::ScratchFile& scratch;
  std::uint64_t sort_bytes = 0;  ///< of each of two sorts, or of a table
  const execution::CancelToken& cancel;
};

}  // namespace meshhier::importing
