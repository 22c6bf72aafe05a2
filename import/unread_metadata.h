// Metadata of glTF that is not read, counted and told.
#pragma once

#include "hierarchy/published.h"

#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::importing {

/// Counts of a scene's metadata that is not read.
struct UnreadMetadata {
  std::uint64_t in_textures = 0;   ///< sets of feature ids that textures have
  std::uint64_t further_sets = 0;  ///< sets beside the one that says the objects
  std::uint64_t tables = 0;        ///< tables that are damaged, or whose schema is not there
  std::uint64_t property_textures = 0, property_attributes = 0;
};

/// Returns the counts that are not 0.
std::vector<SourceCount> source_counts(const UnreadMetadata& unread);
/// Returns what warnings say of such counts, which may be those of many files.
std::vector<std::string> warnings_of_metadata(const std::vector<SourceCount>& counts);

}  // namespace meshhier::importing
