// References of the config's keys, all made from config_schema.h, and of the formats of meshes,
// made from mesh_io/formats.h: for editors, the terminal, the viewer and the documents.
// scripts/references writes those that are kept in files.
#pragma once

#include <string>

namespace meshhier::config {

/// Returns the JSON schema, as in configs/meshhier.schema.json.
std::string schema_text();

/// Returns all keys for a terminal, each with its values, its default, and its meaning.
std::string keys_text();

/// Returns the table of docs/config.md, in Markdown.
std::string keys_markdown();

/// Returns a config that holds every default, for a terminal.
std::string defaults_text();

/// Returns the formats of meshes for a terminal, with their endings, and what is kept of each.
std::string formats_text();

/// Returns the table of docs/input_formats.md, in Markdown.
std::string formats_markdown();

/// Returns the formats of meshes, of the files that belong to them, and of pictures, as JSON:
/// scripts/references makes viewer/src/hierarchy/formats.ts of it.
std::string formats_json();

}  // namespace meshhier::config
