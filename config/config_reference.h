// Describes the config's keys for editors, the terminal and the documents, all from
// config_schema.h. scripts/config_reference writes what is kept in files.
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

}  // namespace meshhier::config
