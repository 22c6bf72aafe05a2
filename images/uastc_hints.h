// Advice for those who turn UASTC into blocks of other kinds, by rules that look at the texels
// alone.
#pragma once

#include "images/uastc_block.h"

#include <array>
#include <span>

namespace meshhier::images {

/// Sets what the mode has of hints. `texels`: those that the block stands for, row by row.
/// Requires the block's mode.
void set_hints(std::span<const Rgba, kBlockTexels> texels, UastcBlock& block);

}  // namespace meshhier::images
