// What the manifest tells of objects.bin, as JSON (docs/file_format.md).
#pragma once

#include "storage/format/object_table.h"
#include "storage/format/sealed_json.h"

#include <nlohmann/json.hpp>

namespace meshhier::storage {

/// Returns the keys of the manifest's `objects` that tell of the file.
nlohmann::ordered_json object_facts_json(const ObjectTableFacts& facts);
/// Parses such an object, in which there may be more. Throws Error(corrupt).
ObjectTableFacts read_object_facts(const JsonObject& object);

}  // namespace meshhier::storage
