// Names as EXT_structural_metadata and 3D Tiles have them.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// Returns a name of ASCII letters, digits and underscores.
std::string as_word(std::string name);
/// Adds a name; if it is there already, it gets a number behind it.
void add_unique(std::vector<std::string>& names, const std::string& name);

/// Returns an id for each name: letters, digits and underscores, no digit first; no id twice.
std::vector<std::string> metadata_ids(std::span<const std::string> names);

}  // namespace meshhier::storage
