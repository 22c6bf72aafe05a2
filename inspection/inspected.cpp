#include "inspection/inspected.h"

#include "base/error.h"
#include "hierarchy/cut.h"
#include "storage/format/layout.h"

#include <algorithm>

namespace meshhier::inspection {
namespace {

storage::HierarchyReader open_checked(storage::FileSystem& files,
                                      const std::filesystem::path& directory,
                                      const InspectOptions& options) {
  storage::HierarchyReader reader(files, directory);
  try {
    if (options.level)
      require_level(reader.tree(), *options.level);
    if (options.node)
      require_node(reader.tree(), *options.node);
  } catch (const Error& error) {
    throw error.within(directory.string());
  }
  return reader;
}

}  // namespace

Inspected::Inspected(storage::FileSystem& files, const std::filesystem::path& directory,
                     const InspectOptions& options)
    : place_(files, directory), reader_(open_checked(place_.files(), directory, options)) {}

std::span<const TileRecord> Inspected::records_of(Level level) const {
  const auto& records = reader_.records();
  const auto before = [](const TileRecord& r, Level l) { return r.node.level < l; };
  const auto begin = std::lower_bound(records.begin(), records.end(), level, before);
  const auto end = std::lower_bound(begin, records.end(), finer(level), before);
  return {begin, end};
}

std::vector<storage::LevelSummary> Inspected::levels() const {
  return storage::summarize_levels(reader_.tree(), reader_.records());
}

storage::CompactnessSummary Inspected::compactness() const {
  return storage::summarize_compactness(reader_.tree(), reader_.records());
}

storage::PictureSummary Inspected::pictures() const {
  return storage::summarize_pictures(reader_.records());
}

storage::SizeSummary Inspected::partition_sizes() const {
  return storage::summarize_sizes(records_of(reader_.tree().depth()), reader_.tile_format());
}

storage::SizeSummary Inspected::all_sizes() const {
  return storage::summarize_sizes(reader_.records(), reader_.tile_format());
}

storage::ForcedCollapses Inspected::forced_collapses() const {
  return storage::summarize_forced_collapses(reader_.records(), reader_.manifest().source.places);
}

std::uint64_t Inspected::bytes_on_disk() const {
  if (place_.archive() != nullptr)
    return place_.archive()->file().size();
  const auto manifest = place_.files().open(storage::manifest_path(reader_.directory()));
  return reader_.manifest().total_bytes + manifest->size();
}

std::string_view normals_of(const storage::Manifest& manifest) {
  return manifest.source.attributes.normals ? "given"
         : manifest.computed_normals        ? "computed"
                                            : "none";
}

}  // namespace meshhier::inspection
