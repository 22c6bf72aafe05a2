#include "render/drawing_cost.h"

#include "render/space.h"

#include <algorithm>
#include <cmath>

namespace meshhier::render {
namespace {

/// Its area and its rows; nothing of what is not finite, and is not drawn.
std::uint64_t samples_of(const Facet& facet, const Camera& camera) {
  const Vec3d a = camera.on_grid(facet[0].position), b = camera.on_grid(facet[1].position),
              c = camera.on_grid(facet[2].position);
  if (!is_finite(a) || !is_finite(b) || !is_finite(c))
    return 0;
  const double area = std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
  const double rows = std::max({a.y, b.y, c.y}) - std::min({a.y, b.y, c.y});
  const double most = double{1} * camera.columns() * camera.rows();
  return static_cast<std::uint64_t>(std::min(area + rows, most));
}

}  // namespace

std::uint64_t samples_to_draw(std::span<const Facet> facets, const Camera& camera) {
  std::uint64_t sum = 0;
  for (const Facet& facet : facets)
    sum += samples_of(facet, camera);
  return sum;
}

}  // namespace meshhier::render
