// What the manifest says of the values of vertices (docs/file_format.md, section 2).
#pragma once

#include "hierarchy/published.h"
#include "storage/format/sealed_json.h"

#include <nlohmann/json_fwd.hpp>

namespace meshhier::storage {

/// An array, one object for each of source.attributes.values.
nlohmann::ordered_json source_values_json(const SourceSummary& source);

/// The inverse: `object` has the array as "values". Fills attributes.values and values.
void read_source_values(const JsonObject& object, SourceSummary& source);

}  // namespace meshhier::storage
