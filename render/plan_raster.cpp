#include "render/plan_raster.h"

#include "base/srgb.h"
#include "render/texel_level.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace meshhier::render {
namespace {

/// What is to blend is seen where it hides at least half of what is behind.
constexpr double kSeenFrom = 0.5;

/// Mixes three numbers or vectors. The corner with the largest share is the base: at a corner the
/// result is its own value, bit for bit.
template <class Value>
Value mixed(const Weights& w, const Value& a, const Value& b, const Value& c) {
  if (w[0] >= w[1] && w[0] >= w[2])
    return a + (b - a) * w[1] + (c - a) * w[2];
  if (w[1] >= w[2])
    return b + (a - b) * w[0] + (c - b) * w[2];
  return c + (a - c) * w[0] + (b - c) * w[1];
}

std::uint8_t screen_byte_of(double light) {
  return LightTable::get().value(
      static_cast<std::uint32_t>(std::clamp(light, 0.0, 1.0) * 65535 + 0.5));
}

/// A triangle's colours.
class PlanSkin {
 public:
  PlanSkin(const PlanMesh& mesh, const Triangle<std::uint32_t>& t) : mesh_(mesh), corners_(t) {
    if (mesh.texture == nullptr)
      return;
    texcoords_ = {mesh.texcoords[t[0]], mesh.texcoords[t[1]], mesh.texcoords[t[2]]};
    level_ = level_of(*mesh.texture, texcoords_,
                      {mesh.places[t[0]], mesh.places[t[1]], mesh.places[t[2]]});
  }

  bool is_opaque() const { return mesh_.texture == nullptr || mesh_.texture->is_opaque(); }
  bool is_seen(const Weights& w) const {
    return is_opaque() || mesh_.texture->is_seen_at(texcoord(w), level_, kSeenFrom);
  }

  void put(const Weights& w, std::uint8_t* pixel) const {
    Vec3d light{1, 1, 1};
    if (!mesh_.lights.empty()) {
      light = mixed(w, to_double(mesh_.lights[corners_[0]]), to_double(mesh_.lights[corners_[1]]),
                    to_double(mesh_.lights[corners_[2]]));
    }
    if (mesh_.texture != nullptr) {
      const Vec3d shown = to_double(mesh_.texture->light_at(texcoord(w), level_));
      light = {light.x * shown.x, light.y * shown.y, light.z * shown.z};
    }
    *pixel++ = screen_byte_of(light.x);
    *pixel++ = screen_byte_of(light.y);
    *pixel++ = screen_byte_of(light.z);
    *pixel = 255;
  }

 private:
  Vec2f texcoord(const Weights& w) const {
    const auto& [a, b, c] = texcoords_;
    return {static_cast<float>(a.u * w[0] + b.u * w[1] + c.u * w[2]),
            static_cast<float>(a.v * w[0] + b.v * w[1] + c.v * w[2])};
  }

  const PlanMesh& mesh_;
  const Triangle<std::uint32_t>& corners_;
  std::array<Vec2f, 3> texcoords_{};
  double level_ = 0;
};

}  // namespace

PlanRaster::PlanRaster(const PlanWindow& window, bool has_colours)
    : window_(window),
      heights_(std::size_t{window.width} * window.height, kNothing),
      colours_(has_colours ? 4 * heights_.size() : 0) {}

GridPoint PlanRaster::in_window(Vec3d place) const {
  const auto steps = [](double pixels) {
    constexpr double kLeast = -double{kMostPlanMargin};
    constexpr double kMost = double{kMostPlanSide} + kMostPlanMargin;
    const double within = pixels > kLeast ? std::min(pixels, kMost) : kLeast;
    return static_cast<std::int64_t>(std::floor(within * kSteps + 0.5));
  };
  return {steps(place.x) - std::int64_t{window_.column} * kSteps,
          steps(place.y) - std::int64_t{window_.row} * kSteps};
}

void PlanRaster::draw(const PlanMesh& mesh) {
  std::vector<GridPoint> points;
  points.reserve(mesh.places.size());
  for (const Vec3d& place : mesh.places)
    points.push_back(in_window(place));
  for (const Triangle<std::uint32_t>& t : mesh.triangles)
    draw(mesh, t, {points[t[0]], points[t[1]], points[t[2]]});
}

void PlanRaster::draw(const PlanMesh& mesh, const Triangle<std::uint32_t>& t,
                      const std::array<GridPoint, 3>& corners) {
  const SampleBox box = box_of(corners, window_.width, window_.height);
  if (box.empty())
    return;
  const double a = mesh.places[t[0]].z, b = mesh.places[t[1]].z, c = mesh.places[t[2]].z;
  const PlanSkin skin(mesh, t);
  const auto always = [](std::int64_t, std::int64_t) { return true; };
  GridTriangle(corners).visit(
      box, always,
      [&](std::int64_t column, std::int64_t row, const Weights& w) {
        const auto pixel = static_cast<std::size_t>(row * window_.width + column);
        const auto height = static_cast<float>(mixed(w, a, b, c));
        if (!(height > heights_[pixel]) || !skin.is_seen(w))
          return;
        heights_[pixel] = height;
        if (!colours_.empty())
          skin.put(w, &colours_[4 * pixel]);
      },
      EdgeRule::closed);
}

}  // namespace meshhier::render
