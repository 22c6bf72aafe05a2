// Finds and removes what is left on disk by builds that were stopped, other commands that were
// killed, and hierarchies that were removed.
#pragma once

#include "storage/format/layout.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

struct FoundLeftover {
  std::filesystem::path path;
  storage::Leftover kind{};
  std::filesystem::path output;  ///< the file or hierarchy that it belongs to
  std::uint64_t bytes = 0;
  bool in_use = false;     ///< a build, or another command, is at work there
  bool only_copy = false;  ///< a hierarchy that was to be replaced, and nothing replaced it
};

/// Finds, in a directory, the leftovers of any output; for a hierarchy, finished or to be, those
/// that belong to it. Ascending by path. Throws Error(io).
std::vector<FoundLeftover> find_leftovers(storage::FileSystem& files,
                                          const std::filesystem::path& directory_or_output);

/// Removes leftovers that are not in use; gives a hierarchy that is the only copy its name back
/// instead. Corrects what has become of one since it was found. Throws Error(io).
void remove_leftovers(storage::FileSystem& files, std::vector<FoundLeftover>& found);

/// Returns a line each and, unless they were `removed` (by remove_leftovers()), one with their sum;
/// of none, a line that says so.
std::string leftovers_text(const std::vector<FoundLeftover>& found, bool removed);
nlohmann::ordered_json leftovers_json(const std::vector<FoundLeftover>& found);

}  // namespace meshhier::pipeline
