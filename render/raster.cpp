#include "render/raster.h"

#include "render/distinct_places.h"
#include "render/mip_texture.h"
#include "render/space.h"
#include "render/texel_level.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace meshhier::render {
namespace {

using Three = std::array<Vec3d, 3>;  ///< of a facet's corners

Vec3f blend(const Weights& weights, const Three& corners) {
  return to_float(corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]);
}

using Places = Three;  ///< on the grid

/// The normal of the side from which the corners turn counter-clockwise, by the view's axes. The
/// grid's y goes down and its z away: both turn.
Vec3f flat_normal(const Places& places) {
  const Vec3d across = cross(places[1] - places[0], places[2] - places[0]);
  const double size = length(across);
  if (!(size > 0) || !std::isfinite(size))
    return {0, 0, 1};
  return to_float(Vec3d{across.x, -across.y, -across.z} * (1 / size));
}

/// A sample's threshold, from 0 to 1: those of a pixel are all different, and evenly spread.
double threshold_at(std::int64_t column, std::int64_t row, std::uint32_t samples) {
  // Neighbours in a row or column are far from each other in the order.
  constexpr std::int64_t kStride = 7;
  const std::int64_t side = samples, count = side * side;
  const std::int64_t place = row % side * side + column % side;
  return (static_cast<double>(place * kStride % count) + 0.5) / static_cast<double>(count);
}

/// The frames that a normal map is relative to, as the camera sees them: from behind turned round.
class MapFrames {
 public:
  MapFrames(const Camera& camera, const Skin& skin, const Three& normals, const Places& places,
            bool is_behind)
      : skin_(skin), level_(level_of(*skin.normal_map, skin.texcoords, places)) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d tangent = to_double(camera.turned(unit_or_zero(skin.tangents[i])));
      bitangents_[i] = cross(normals[i], tangent) * (skin.is_mirrored ? -1.0 : 1.0);
      tangents_[i] = is_behind ? tangent * -1 : tangent;
    }
  }

  Vec3f normal(const Weights& w, Vec2f texcoord, Vec3f unmapped) const {
    const Vec3f numbers = skin_.normal_map->light_at(texcoord, level_) * 2.0F;
    const Vec3f tangent = unit_or_zero(blend(w, tangents_));
    const Vec3f bitangent = unit_or_zero(blend(w, bitangents_));
    const Vec3f mixed = unit_or_zero(tangent * (numbers.x - 1) + bitangent * (numbers.y - 1) +
                                     unmapped * (numbers.z - 1));
    return mixed == Vec3f{} ? unmapped : mixed;
  }

 private:
  const Skin& skin_;
  double level_;
  Three tangents_, bitangents_;
};

/// A facet's surface as the camera sees it.
class SeenSurface {
 public:
  SeenSurface(const Camera& camera, const Facet& facet, const Skin& skin, const Places& places)
      : skin_(skin), flat_(flat_normal(places)) {
    const bool is_behind = flat_.z < 0;
    if (is_behind)
      flat_ = flat_ * -1;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3f normal = camera.turned(unit_or_zero(facet[i].normal));
      normals_[i] = to_double(is_behind ? normal * -1 : normal);
      colours_[i] = to_double(facet[i].colour);
    }
    colour_ = facet[0].colour;
    is_one_colour_ = facet[1].colour == colour_ && facet[2].colour == colour_;
    if (skin.texture != nullptr)
      level_ = level_of(*skin.texture, skin.texcoords, places);
    if (skin.normal_map != nullptr)
      frames_.emplace(camera, skin, normals_, places, is_behind);
  }

  Vec3f normal(const Weights& w) const {
    const Vec3f unit = unit_or_zero(blend(w, normals_));
    if (unit == Vec3f{})
      return flat_;
    return frames_ ? frames_->normal(w, texcoord(w), unit) : unit;
  }
  Vec3f colour(const Weights& w) const {
    if (skin_.texture == nullptr)
      return corner_colour(w);
    const Vec3f light = skin_.texture->light_at(texcoord(w), level_);
    if (!skin_.is_tinted)
      return light;
    const Vec3f tint = corner_colour(w);
    return {light.x * tint.x, light.y * tint.y, light.z * tint.z};
  }
  bool is_opaque() const { return skin_.texture == nullptr || skin_.texture->is_opaque(); }
  bool is_seen(const Weights& w, double threshold) const {
    return skin_.texture->is_seen_at(texcoord(w), level_, threshold);
  }

 private:
  Vec3f corner_colour(const Weights& w) const {
    // The sum of weights is 1 but for the last bits of a double: a float's blend with itself is
    // that float.
    return is_one_colour_ ? colour_ : blend(w, colours_);
  }
  Vec2f texcoord(const Weights& w) const {
    const auto& [a, b, c] = skin_.texcoords;
    return {static_cast<float>(a.u * w[0] + b.u * w[1] + c.u * w[2]),
            static_cast<float>(a.v * w[0] + b.v * w[1] + c.v * w[2])};
  }

  const Skin& skin_;
  Vec3f flat_;  ///< the facet's own normal
  Three normals_, colours_;
  Vec3f colour_;  ///< of the first corner
  bool is_one_colour_ = false;
  double level_ = 0;                 ///< of its texture
  std::optional<MapFrames> frames_;  ///< with a normal map
};

/// Nothing if one of them is not finite.
std::optional<Places> places_of(const Camera& camera, const Facet& facet) {
  Places places;
  for (std::size_t i = 0; i < 3; ++i) {
    places[i] = camera.on_grid(facet[i].position);
    if (!is_finite(places[i]))
      return std::nullopt;
  }
  return places;
}

/// No depth within the facet is less, however it was rounded.
float least_depth(const Places& places) {
  constexpr double kRounding = 1e-12;  // a few thousand times that of depth_at()
  const auto& [a, b, c] = places;
  return static_cast<float>(std::min({a.z, b.z, c.z}) -
                            kRounding * (std::abs(a.z) + std::abs(b.z) + std::abs(c.z)));
}

float depth_at(const Places& places, const Weights& w) {
  return static_cast<float>(places[0].z * w[0] + places[1].z * w[1] + places[2].z * w[2]);
}

}  // namespace

Raster::Raster(const Camera& camera) : Raster(camera, {0, camera.framing().height}) {}

Raster::Raster(const Camera& camera, PixelRows rows)
    : camera_(camera),
      rows_(rows),
      samples_(std::size_t{camera.columns()} * rows.count * camera.framing().samples),
      run_depths_(camera.columns(), rows.count * camera.framing().samples) {}

void Raster::draw(const Facet& facet, const Skin& skin) {
  const std::optional<Places> places = places_of(camera_, facet);
  if (!places)
    return;
  const auto& [a, b, c] = *places;
  const std::array<GridPoint, 3> corners{in_rows(a), in_rows(b), in_rows(c)};
  const SampleBox box = box_of(corners, columns(), rows());
  if (!box.empty())
    draw(facet, skin, *places, corners, box);
}

void Raster::draw(const Facet& facet, const Skin& skin, const std::array<Vec3d, 3>& places,
                  const std::array<GridPoint, 3>& corners, const SampleBox& box) {
  std::optional<SeenSurface> surface;  // many facets lie between samples, or behind others
  const float least = least_depth(places);
  const auto is_seen = [&](std::int64_t run, std::int64_t row) {
    return !run_depths_.hides(run, row, least, [&](std::size_t i) { return samples_[i].depth; });
  };
  const std::int64_t row_samples = columns();
  GridTriangle(corners).visit(
      box, is_seen, [&](std::int64_t column, std::int64_t row, const Weights& weights) {
        Sample& sample = samples_[static_cast<std::size_t>(row * row_samples + column)];
        const float depth = depth_at(places, weights);
        if (!(depth < sample.depth))
          return;
        if (!surface)
          surface.emplace(camera_, facet, skin, places);
        if (!surface->is_opaque() &&
            !surface->is_seen(weights, threshold_at(column, row, framing().samples)))
          return;
        sample = {depth, surface->normal(weights), surface->colour(weights)};
      });
}

void Raster::draw(std::span<const Facet> facets) {
  for (const Facet& facet : facets)
    draw(facet);
}

void Raster::draw(std::span<const Facet> facets, const DistinctPlaces& distinct) {
  struct OnGrid {
    Vec3d place;
    GridPoint point;
    bool is_finite = false;
  };
  std::vector<OnGrid> all;
  all.reserve(distinct.places.size());
  for (const Vec3f& position : distinct.places) {
    const Vec3d place = camera_.on_grid(position);
    all.push_back(is_finite(place) ? OnGrid{place, in_rows(place), true} : OnGrid{});
  }
  const Skin plain;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const auto& [p, q, r] = distinct.corners[i];
    const OnGrid &a = all[p], &b = all[q], &c = all[r];
    if (!a.is_finite || !b.is_finite || !c.is_finite)
      continue;
    const std::array<GridPoint, 3> corners{a.point, b.point, c.point};
    const SampleBox box = box_of(corners, columns(), rows());
    if (!box.empty())
      draw(facets[i], plain, {a.place, b.place, c.place}, corners, box);
  }
}

}  // namespace meshhier::render
