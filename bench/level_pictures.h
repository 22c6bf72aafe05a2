// Pictures of levels, for the comparisons of shading and textures.
#pragma once

#include "base/vec.h"
#include "hierarchy/ids.h"
#include "hierarchy/tree.h"
#include "storage/format/manifest.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::bench {

struct NamedPicture {
  std::string name;  ///< "view1_level3_own.png"
  std::vector<std::byte> png;
};

/// The level asked for, or all, ascending. Throws Error(usage) if there is no such level.
std::vector<Level> levels_of(const Tree& tree, const std::optional<Level>& asked);

/// The input's box, relative to the origin as stored positions are.
BoundsD stored_box(const storage::Manifest& manifest);

/// The direction that points up in the input.
Vec3d up_of(const storage::Manifest& manifest);

}  // namespace meshhier::bench
