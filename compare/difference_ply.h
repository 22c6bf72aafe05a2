// The PLY that a comparison writes.
#pragma once

#include "base/vec.h"
#include "compare/cut_surface.h"
#include "hierarchy/triangle.h"
#include "storage/io/output_file.h"
#include "storage/io/spool.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace meshhier::comparing {

/// The name of the distances.
inline constexpr const char* kDistance = "distance";

/// Vertices with their distances and triangles, until their counts are known.
class DifferencePly {
 public:
  DifferencePly(storage::FileSystem& files, const storage::OutputRequest& request,
                std::uint64_t memory_bytes, const std::function<void()>& check);

  /// Takes the tile's own places with their distances, and its triangles.
  void add(const PlacedTile& tile, std::span<const double> distances);
  /// Writes all that was added, once: the file is there then. `check` may throw.
  void write(Vec3d origin, const std::string& comment, const std::function<void()>& check);

 private:
  storage::OutputFile output_;
  storage::MemoryPool pool_;
  storage::ScratchFile scratch_;
  storage::RecordSpool<Vec3f> positions_;
  storage::RecordSpool<float> distances_;
  storage::RecordSpool<Triangle<std::uint32_t>> triangles_;
};

}  // namespace meshhier::comparing
