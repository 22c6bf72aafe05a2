// A city of boxes, as an OBJ file with an object a building, and a table of the buildings.
#pragma once

#include "storage/io/output_file.h"

#include <cstdint>

namespace meshhier::bench {

struct CityOptions {
  std::uint64_t buildings = 100'000;  ///< 1 to 2^24
  std::uint64_t seed = 1;
};

struct CitySizes {
  std::uint64_t mesh_bytes = 0, table_bytes = 0;
};

/// Writes the mesh, and beside it NAME.csv: name, height, storeys, built, listed, owner. A building
/// has ten triangles; its name is "district 03/street 17/building 0000042". Of a hundred
/// buildings one has no row; of a hundred rows one is no building's. A pure function of the
/// options. Throws as storage::write_output(), and Error(usage) if an option is out of its range.
CitySizes write_city(storage::FileSystem& files, const storage::OutputRequest& mesh,
                     const CityOptions& options);

}  // namespace meshhier::bench
