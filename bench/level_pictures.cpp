#include "bench/level_pictures.h"

#include "hierarchy/cut.h"

namespace meshhier::bench {

std::vector<Level> levels_of(const Tree& tree, const std::optional<Level>& asked) {
  if (asked) {
    require_level(tree, *asked);
    return {*asked};
  }
  std::vector<Level> levels(std::size_t{raw(tree.depth())} + 1);
  for (std::size_t i = 0; i < levels.size(); ++i)
    levels[i] = static_cast<Level>(i);
  return levels;
}

BoundsD stored_box(const storage::Manifest& manifest) {
  const BoundsD& box = manifest.source.bounds;
  return {box.min - manifest.origin, box.max - manifest.origin};
}

Vec3d up_of(const storage::Manifest& manifest) {
  return manifest.up == UpAxis::z ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
}

}  // namespace meshhier::bench
