// The manifest describes objects.bin and object_words.bin; this reads and writes that JSON
// (docs/file_format.md).
#pragma once

#include "storage/format/layout.h"
#include "storage/format/manifest.h"
#include "storage/format/object_table.h"
#include "storage/format/sealed_json.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::storage {

/// Returns the keys of the manifest's `objects`, or of its `words`, that tell of the `file`.
nlohmann::ordered_json object_facts_json(const ObjectTableFacts& facts,
                                         const std::filesystem::path& file = objects_path({}));
/// Parses such an object, in which there may be more. Throws Error(corrupt).
ObjectTableFacts read_object_facts(const JsonObject& object,
                                   const std::filesystem::path& file = objects_path({}));

/// A file with a table of a hierarchy's objects.
struct ObjectFile {
  std::filesystem::path name;
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH3-64
};
/// Returns all such files; none of no objects.
std::vector<ObjectFile> object_files(const std::optional<ObjectsSummary>& objects);
/// Returns the bytes of all.
std::uint64_t object_file_bytes(const std::optional<ObjectsSummary>& objects);

}  // namespace meshhier::storage
