// Charts of a partition that show the same texels.
#pragma once

#include "texture/leaf_atlas.h"
#include "texture/texel_charts.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// Part of a picture that some pieces of charts show.
struct SharedTexels {
  std::uint32_t material = 0;
  TexcoordBox box{};
};

/// Where a piece lies in what it shares.
struct SharedPlace {
  std::uint32_t shared = 0;  ///< its number
  double u = 0, v = 0;       ///< what is added to the piece's coordinates; whole periods
};

struct SharedCharts {
  std::vector<SharedTexels> shared;
  std::vector<SharedPlace> places;  ///< of each piece
};

/// Pieces are put together, the largest first, while that saves texels and `most_side` is not
/// exceeded; where a picture repeats, so is a piece moved. Not the least of texels that can be, as
/// each piece looks at a few others only. Deterministic; O(p log p) for p pieces.
SharedCharts share_texels(std::span<const ChartPiece> pieces,
                          std::span<const AtlasMaterial> materials, std::uint32_t most_side);

}  // namespace meshhier::texture
