#include "hierarchy/mesh_name.h"

#include <algorithm>
#include <cstddef>

namespace meshhier {
namespace {

/// Letters of ASCII are equal to their capitals. `ending` is in small letters.
bool has_ending(std::string_view name, std::string_view ending) {
  return name.size() >= ending.size() &&
         std::equal(ending.begin(), ending.end(), name.end() - ending.size(),
                    [](char small, char c) {
                      return c == small || (small >= 'a' && c == small - 'a' + 'A');
                    });
}

/// 0 if it is no mesh's name.
std::size_t stem_length(std::string_view name) {
  if (has_ending(name, ".gz"))
    name.remove_suffix(3);
  for (const std::string_view ending : {".ply", ".obj", ".stl", ".off", ".gltf", ".glb"}) {
    if (has_ending(name, ending))
      return name.size() - ending.size();
  }
  return 0;
}

}  // namespace

bool is_mesh_name(std::string_view name) {
  return !name.starts_with('.') && stem_length(name) > 0;
}

std::string mesh_stem(std::string_view name) {
  return std::string(name.substr(0, stem_length(name)));
}

}  // namespace meshhier
