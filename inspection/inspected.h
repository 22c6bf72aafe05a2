// A hierarchy that is told about, and the facts that both a text and a JSON of it need.
#pragma once

#include "images/formats.h"
#include "inspection/inspect.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/level_summary.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace meshhier::inspection {

/// Reads manifest and index. Each sum is O(tiles).
class Inspected {
 public:
  /// Throws as inspect_text().
  Inspected(storage::FileSystem& files, const std::filesystem::path& directory,
            const InspectOptions& options);

  const storage::HierarchyReader& reader() const { return reader_; }
  std::span<const TileRecord> records_of(Level level) const;
  std::vector<storage::LevelSummary> levels() const;
  storage::CompactnessSummary compactness() const;
  storage::PictureSummary pictures() const;
  storage::SizeSummary partition_sizes() const;
  storage::SizeSummary all_sizes() const;
  storage::ForcedCollapses forced_collapses() const;
  /// Returns the bytes of the archive, or of the whole directory: what the manifest counts, and
  /// itself.
  std::uint64_t bytes_on_disk() const;

 private:
  storage::HierarchyFiles place_;
  storage::HierarchyReader reader_;
};

/// Returns where the tiles' normals come from.
std::string_view normals_of(const storage::Manifest& manifest);

/// Returns the bytes of a texel in the memory of a graphics device that knows blocks, with smaller
/// and smaller copies.
template <class Format>
double gpu_bytes(const Format& format) {
  constexpr double kCopies = 4.0 / 3;
  return kCopies * images::costs_of(format).device_bytes;
}

}  // namespace meshhier::inspection
