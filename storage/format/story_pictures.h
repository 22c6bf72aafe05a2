// The pictures that lie beside a story and belong to it (docs/serving.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// Whether pages show a file of that name in stories. Drawings that may hold scripts (SVG) are not
/// shown.
bool is_picture_name(std::string_view name);

/// Returns the pictures that a story's file (JSON, of any length) names and has beside it: paths
/// downwards from its folder, "pictures/1.jpg", ascending, each once. Pictures within it, on other
/// hosts, above it, in hidden folders, and of other names are left out. A text that is no JSON
/// names none.
std::vector<std::string> pictures_beside(std::string_view story);

}  // namespace meshhier::storage
