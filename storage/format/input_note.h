// A note beside a hierarchy, at input_note_path(), names the files that it was made of, for whoever
// watches them.
#pragma once

#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::storage {

struct NotedFile {
  std::filesystem::path path;  ///< from the folder of the first one
  FileIdentity identity;       ///< when it was read
  std::uint64_t checksum = 0;  ///< FileChecksum
};

struct InputNote {
  std::uint64_t content = 0;                   ///< `source.checksum` of the hierarchy's manifest
  std::vector<NotedFile> files;                ///< the mesh, and what belongs to it
  std::vector<std::filesystem::path> awaited;  ///< files that were looked for and were not there
  std::vector<std::string> warnings{};         ///< the build's, a line each
  /// The program, its config and the files that this names, as who asks compares them; null: not
  /// known.
  nlohmann::ordered_json build = nullptr;
};

/// Returns JSON that carries its own checksum.
std::string to_json_text(const InputNote& note);
/// Reads such a file. Throws Error(io), Error(corrupt) that starts with `name`.
InputNote read_input_note(const File& file, const std::string& name);
/// Returns the note in a place, through no link: nothing if there is none, it is damaged, or it is
/// no regular file. Never throws for what lies there.
std::optional<InputNote> find_input_note(FileSystem& files, const std::filesystem::path& path);
/// Writes a note in the place of an older one; it is there complete or not at all. Throws as
/// OutputFile.
void write_input_note(FileSystem& files, const std::filesystem::path& path, const InputNote& note);

}  // namespace meshhier::storage
