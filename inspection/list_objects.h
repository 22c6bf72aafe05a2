// Tells of the objects of a hierarchy, one line each, from the table alone.
#pragma once

#include "execution/cancel.h"
#include "storage/io/file.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::inspection {

/// Which objects are told of, and how.
struct ListedObjects {
  std::string prefix;   ///< those whose names begin so; empty: all
  std::string where{};  ///< and that meet this condition (exporting::ObjectCondition); empty: all
  bool as_json = false;
  std::optional<std::string> words{};  ///< those whose names have all of these words
};

/// Hands a line for each object to `visit`, ascending by name: its number, name, triangles, area
/// and properties; as JSON an object that also has its box. Reads the table block by block. Throws
/// Error(usage) if the hierarchy has no objects, `where` is no condition, or words have no letters;
/// Error(io | corrupt | interrupted).
void list_objects(storage::FileSystem& files, const std::filesystem::path& directory,
                  const ListedObjects& which, const execution::CancelToken& cancel,
                  const std::function<void(std::string_view)>& visit);

}  // namespace meshhier::inspection
