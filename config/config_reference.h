// What is told of the config's keys, all made from config_schema.h, and of the formats of meshes,
// made from mesh_io/formats.h: for editors, the terminal, the viewer and the documents.
// scripts/references writes what is kept in files.
#pragma once

#include <string>

namespace meshhier::config {

/// The JSON schema, as in configs/meshhier.schema.json.
std::string schema_text();

/// All keys for a terminal: what each takes, its default, and what it means.
std::string keys_text();

/// The table of docs/config.md, in Markdown.
std::string keys_markdown();

/// A config that holds every default, for a terminal.
std::string defaults_text();

/// The formats of meshes for a terminal, with their endings, and what is kept of each.
std::string formats_text();

/// The table of docs/input_formats.md, in Markdown.
std::string formats_markdown();

/// The endings of meshes and of what belongs to them, as in viewer/page/upload/formats.json.
std::string formats_json();

}  // namespace meshhier::config
