// The batch table of a b3dm (OGC, 3D Tiles 1.0, section 10.5): what its features are.
#pragma once

#include "mesh_io/feature_table.h"
#include "mesh_io/tile_file.h"
#include "storage/io/file.h"

#include <cstdint>
#include <memory>

namespace meshhier::mesh_io {

/// Opens the table; null if there is none. Columns are lists of JSON, or numbers in the binary
/// part; hierarchies of classes (an extension) are passed over. There are as many rows as the
/// longest column has. Throws Error(input) if it is no JSON, or if a column reaches beyond the
/// binary part, Error(budget) if it takes more than `most_bytes` of memory.
std::unique_ptr<FeatureTable> open_batch_table(std::shared_ptr<const storage::File> file,
                                               const BatchTablePlace& place,
                                               std::uint64_t most_bytes);

}  // namespace meshhier::mesh_io
