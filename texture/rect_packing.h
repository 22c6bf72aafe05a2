// Rectangles side by side, as close as can be: a skyline (stb_rect_pack), the highest first.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::texture {

/// In units of any size, up to 8192 each; what has a side of 0 takes no room.
struct RectSize {
  std::uint32_t width = 0, height = 0;
};
struct RectPlace {
  std::uint32_t x = 0, y = 0;
};

struct RectPacking {
  std::uint32_t width = 0, height = 0;
  std::vector<RectPlace> places;  ///< one a rectangle
};

/// In a box of that width, of the least height that is found. None if it would be higher than
/// `box.height`. Deterministic, O(n width).
std::optional<RectPacking> pack_into(RectSize box, std::span<const RectSize> sizes);

/// Into the smallest box of a few shapes, with sides of at most `most_side`; none if none has room.
std::optional<RectPacking> pack_tightly(std::span<const RectSize> sizes, std::uint32_t most_side);

}  // namespace meshhier::texture
