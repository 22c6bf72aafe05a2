#include "texture/rect_packing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>

// Rectangles come sorted, in one order also among equals: its own sort has nothing to do.
#define STBRP_SORT(base, count, size, compare) static_cast<void>(compare)
#define STBRP_STATIC
#define STB_RECT_PACK_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_rect_pack.h>
#pragma GCC diagnostic pop

namespace meshhier::texture {
namespace {

using Rects = std::vector<stbrp_rect>;

std::uint64_t area_of(std::span<const RectSize> sizes) {
  std::uint64_t area = 0;
  for (const RectSize& size : sizes)
    area += std::uint64_t{size.width} * size.height;
  return area;
}

Rects rects_of(std::span<const RectSize> sizes) {
  Rects rects(sizes.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    rects[i].id = static_cast<int>(i);
    rects[i].w = static_cast<stbrp_coord>(sizes[i].width);
    rects[i].h = static_cast<stbrp_coord>(sizes[i].height);
  }
  return rects;
}

/// The largest first, by what `key` says of them.
template <class Key>
Rects sorted(Rects rects, const Key& key) {
  std::sort(rects.begin(), rects.end(), [&](const stbrp_rect& a, const stbrp_rect& b) {
    return std::tuple(key(b), b.w, a.id) < std::tuple(key(a), a.w, b.id);
  });
  return rects;
}
Rects by_height(const Rects& rects) {
  return sorted(rects, [](const stbrp_rect& r) { return r.h; });
}
Rects by_longer_side(const Rects& rects) {
  return sorted(rects, [](const stbrp_rect& r) { return std::max(r.w, r.h); });
}
Rects by_area(const Rects& rects) {
  return sorted(rects, [](const stbrp_rect& r) { return std::int64_t{r.w} * r.h; });
}

std::optional<RectPacking> pack_sorted(RectSize box, Rects& rects, int heuristic) {
  std::vector<stbrp_node> nodes(box.width);
  stbrp_context context;
  stbrp_init_target(&context, static_cast<int>(box.width), static_cast<int>(box.height),
                    nodes.data(), static_cast<int>(nodes.size()));
  stbrp_setup_heuristic(&context, heuristic);
  for (stbrp_rect& rect : rects) {  // one at a time, so that the first without a place ends it
    if (stbrp_pack_rects(&context, &rect, 1) == 0)
      return std::nullopt;
  }
  RectPacking packing{box.width, 0, std::vector<RectPlace>(rects.size())};
  for (const stbrp_rect& rect : rects) {
    packing.places[static_cast<std::size_t>(rect.id)] = {static_cast<std::uint32_t>(rect.x),
                                                         static_cast<std::uint32_t>(rect.y)};
    packing.height = std::max(packing.height, static_cast<std::uint32_t>(rect.y + rect.h));
  }
  return packing;
}

}  // namespace

std::optional<RectPacking> pack_into(RectSize box, std::span<const RectSize> sizes) {
  if (area_of(sizes) > std::uint64_t{box.width} * box.height)
    return std::nullopt;
  const Rects rects = rects_of(sizes);
  for (const auto& order : {by_height, by_longer_side, by_area}) {
    Rects ordered = order(rects);
    for (const int heuristic :
         {STBRP_HEURISTIC_Skyline_BL_sortHeight, STBRP_HEURISTIC_Skyline_BF_sortHeight}) {
      if (std::optional<RectPacking> packing = pack_sorted(box, ordered, heuristic))
        return packing;
    }
  }
  return std::nullopt;
}

std::optional<RectPacking> pack_tightly(std::span<const RectSize> sizes, std::uint32_t most_side) {
  std::uint32_t widest = 1;
  for (const RectSize& size : sizes)
    widest = std::max(widest, size.width);
  const auto side =
      static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(area_of(sizes)))));
  Rects rects = by_height(rects_of(sizes));
  std::optional<RectPacking> best;
  const auto box_of = [](const RectPacking& p) { return std::uint64_t{p.width} * p.height; };
  constexpr std::uint64_t kShapes = 8;
  for (std::uint64_t shape = 0; shape <= kShapes; ++shape) {
    const std::uint64_t wished = std::max<std::uint64_t>(widest, side + side * shape / kShapes);
    const auto width = static_cast<std::uint32_t>(std::min<std::uint64_t>(most_side, wished));
    std::optional<RectPacking> packing =
        pack_sorted({width, most_side}, rects, STBRP_HEURISTIC_Skyline_BL_sortHeight);
    if (packing && (!best || box_of(*packing) < box_of(*best)))
      best = std::move(packing);
  }
  return best;
}

}  // namespace meshhier::texture
