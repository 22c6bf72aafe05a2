#include "render/reflection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meshhier::render {
namespace {

/// A dielectric mirrors this part of light that falls straight on it.
constexpr double kMirrored = 0.04;

Vec3d times(Vec3d a, Vec3d b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

double cubed(double value) {
  return value * value * value;
}

/// Schlick 1994.
double fresnel(double cosine) {
  const double grazing = (1 - cosine) * (1 - cosine);
  return kMirrored + (1 - kMirrored) * grazing * grazing * (1 - cosine);
}

/// The coat's part of a lamp's light: GGX with Smith's shadows (Heitz 2014), and what is scattered
/// twice and more (Turquin 2019), which is 2 % of it.
double coat_of(double to_light, double to_viewer, double to_half, double roughness) {
  constexpr double kScattered = 1.02;
  const double width = roughness * roughness * roughness * roughness;
  const auto shadow = [&](double one, double other) {
    return one * std::sqrt(width + (1 - width) * other * other);
  };
  const double visible =
      0.5 / std::max(shadow(to_light, to_viewer) + shadow(to_viewer, to_light), 1e-6);
  const double spread = to_half * to_half * (width - 1) + 1;
  return kScattered * visible * width / (std::numbers::pi * spread * spread);
}

/// The part of light from everywhere that comes through the coat: within 0.005 of the integral, for
/// a roughness from 0.7 on.
double through_coat(double to_viewer, double roughness) {
  const double rougher = roughness - kRoughness;
  return 0.974 + 0.0452 * rougher - (0.08 - 0.0824 * rougher) * cubed(1 - to_viewer);
}

/// `viewer`: of length 1.
Vec3d from_lamp(const LitSurface& surface, const Lamp& lamp, Vec3d viewer) {
  const double to_light = dot(surface.normal, lamp.towards);
  if (to_light <= 0)
    return {};
  const Vec3d between = lamp.towards + viewer;
  const Vec3d half = between * (1 / std::max(length(between), 1e-12));
  const double mirrored = fresnel(std::clamp(dot(viewer, half), 0.0, 1.0));
  const double to_viewer = std::clamp(dot(surface.normal, viewer), 0.0, 1.0);
  const double to_half = std::clamp(dot(surface.normal, half), 0.0, 1.0);
  const double coat = mirrored * coat_of(to_light, to_viewer, to_half, surface.roughness);
  const Vec3d below = surface.colour * ((1 - mirrored) / std::numbers::pi);
  return times(lamp.light, below + Vec3d{coat, coat, coat}) * to_light;
}

}  // namespace

Vec3d reflected(const LitSurface& surface, const LightRig& rig) {
  constexpr Vec3d kViewer{0, 0, 1};
  const double up = (1 + dot(surface.normal, rig.upward)) / 2;
  const double to_viewer = std::clamp(surface.normal.z, 0.0, 1.0);
  const Vec3d around = rig.ground * (1 - up) + rig.sky * up;
  Vec3d light = times(around, surface.colour) *
                (through_coat(to_viewer, surface.roughness) / std::numbers::pi);
  for (const Lamp& lamp : rig.lamps)
    light = light + from_lamp(surface, lamp, kViewer);
  return light;
}

Vec3d toned(Vec3d light) {
  constexpr double kCompressed = 0.8 - 0.04, kDesaturation = 0.15;
  const double least = std::min({light.x, light.y, light.z});
  const double offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
  const Vec3d colour = light - Vec3d{offset, offset, offset};
  const double peak = std::max({colour.x, colour.y, colour.z});
  if (peak < kCompressed)
    return colour;
  constexpr double kRest = 1 - kCompressed;
  const double lower = 1 - kRest * kRest / (peak + kRest - kCompressed);
  const double white = 1 - 1 / (kDesaturation * (peak - lower) + 1);
  return colour * (lower / peak * (1 - white)) + Vec3d{lower, lower, lower} * white;
}

}  // namespace meshhier::render
