// The pictures that lie beside a story and belong to it (docs/serving.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// Whether a file of that name is a picture that pages show in stories. Drawings that may hold
/// scripts (SVG) are none.
bool is_picture_name(std::string_view name);

/// What a story's file (JSON, of any length) names as pictures and has beside it: paths downwards
/// from its folder, "pictures/1.jpg", ascending, each once. Left out are pictures within it, on
/// other hosts, above it, in hidden folders, and of other names; of what is no JSON, all.
std::vector<std::string> pictures_beside(std::string_view story);

}  // namespace meshhier::storage
