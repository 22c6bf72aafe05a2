// Cuts that nobody chose, for checks of what must hold for every cut.
#pragma once

#include "hierarchy/cut.h"
#include "hierarchy/tree.h"

#include <cstdint>

namespace meshhier::exporting {

/// Returns a pseudo-random cut that mixes all levels; the same for the same seed everywhere.
Cut random_cut(const Tree& tree, std::uint64_t seed);

}  // namespace meshhier::exporting
