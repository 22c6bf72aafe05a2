// The manifest's array on the values of vertices (docs/file_format.md, section 2).
#pragma once

#include "hierarchy/published.h"
#include "storage/format/sealed_json.h"

#include <nlohmann/json_fwd.hpp>

namespace meshhier::storage {

/// Returns an array with one object for each of source.attributes.values.
nlohmann::ordered_json source_values_json(const SourceSummary& source);

/// Reads that array, which `object` has as "values"; fills attributes.values and values. Throws as
/// JsonObject.
void read_source_values(const JsonObject& object, SourceSummary& source);

}  // namespace meshhier::storage
