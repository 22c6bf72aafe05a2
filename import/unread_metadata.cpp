#include "import/unread_metadata.h"

#include "base/plain_text.h"
#include "import/input_record.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

struct UnreadRow {
  std::uint64_t UnreadMetadata::*count;
  std::string_view name;  ///< that of the SourceCount
  std::string_view things, why;
};
constexpr std::array kUnreadRows{
    UnreadRow{&UnreadMetadata::in_textures, kFeaturesInTextures, "feature id sets",
              "only ids of vertices make objects, not those of texels"},
    UnreadRow{&UnreadMetadata::further_sets, kFurtherFeatures, "feature id sets",
              "the first one with a property table makes the objects"},
    UnreadRow{&UnreadMetadata::tables, kUnreadTables, "property tables",
              "damaged, or without a schema that is there; \"objects\": \"feature\" stops and says "
              "what is wrong"},
    UnreadRow{&UnreadMetadata::property_textures, kPropertyTextures, "property textures",
              "values of texels"},
    UnreadRow{&UnreadMetadata::property_attributes, kPropertyAttributes, "property attributes",
              "values of vertices are those that are stored, whatever these say"}};

}  // namespace

std::vector<SourceCount> source_counts(const UnreadMetadata& unread) {
  std::vector<SourceCount> counts;
  for (const UnreadRow& row : kUnreadRows)
    add_count(counts, row.name, unread.*row.count);
  return counts;
}

std::vector<std::string> warnings_of_metadata(const std::vector<SourceCount>& counts) {
  std::vector<std::string> warnings;
  for (const UnreadRow& row : kUnreadRows) {
    const auto found = std::ranges::find(counts, row.name, &SourceCount::name);
    if (found != counts.end())
      warnings.push_back(
          fmt::format("{} not read: {}", counted(found->count, row.things), row.why));
  }
  return warnings;
}

}  // namespace meshhier::importing
