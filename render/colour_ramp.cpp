#include "render/colour_ramp.h"

#include "base/named_value.h"
#include "base/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

namespace meshhier::render {
namespace {

// Colours of a screen, at equal steps.
constexpr std::array<std::uint32_t, 11> kViridis{0x440154, 0x482475, 0x414487, 0x355f8d,
                                                 0x2a788e, 0x21918c, 0x22a884, 0x44bf70,
                                                 0x7ad151, 0xbddf26, 0xfde725};
constexpr std::array<std::uint32_t, 10> kCividis{0x00224e, 0x123570, 0x3b496c, 0x575d6d, 0x707173,
                                                 0x8a8678, 0xa59c74, 0xc3b369, 0xe1cc55, 0xfee838};
constexpr std::array<std::uint32_t, 10> kTurbo{0x30123b, 0x4662d7, 0x36aaf9, 0x1ae4b6, 0x72fe5e,
                                               0xc8ef34, 0xfaba39, 0xf66b19, 0xcb2a04, 0x7a0403};
constexpr std::array<std::uint32_t, 11> kCoolwarm{0x3b4cc0, 0x5977e3, 0x7b9ff9, 0x9ebeff,
                                                  0xc0d4f5, 0xdddcdc, 0xf2cbb7, 0xf7ac8e,
                                                  0xee8468, 0xd65244, 0xb40426};

struct Ramp {
  std::string_view name;
  ColourRamp value;
  std::span<const std::uint32_t> colours;
};
constexpr std::array kRamps{
    Ramp{"viridis", ColourRamp::viridis, kViridis}, Ramp{"cividis", ColourRamp::cividis, kCividis},
    Ramp{"turbo", ColourRamp::turbo, kTurbo}, Ramp{"coolwarm", ColourRamp::coolwarm, kCoolwarm}};

Vec3d screen_colour(std::uint32_t hex) {
  return {static_cast<double>(hex >> 16) / 255, static_cast<double>((hex >> 8) & 255) / 255,
          static_cast<double>(hex & 255) / 255};
}

Vec3d lights_of(Vec3d screen) {
  return {light_of(screen.x), light_of(screen.y), light_of(screen.z)};
}

Vec3f as_light(Vec3d screen) {
  return to_float(lights_of(screen));
}

}  // namespace

Vec3d screen_light(std::uint32_t rgb) {
  return lights_of(screen_colour(rgb));
}

std::optional<ColourRamp> ramp_named(std::string_view name) {
  return value_named(kRamps, name);
}

Vec3f ramp_colour(ColourRamp ramp, double part) {
  const std::span<const std::uint32_t> stops = row_with(kRamps, ramp).colours;
  const double at = std::clamp(part, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const auto first = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const Vec3d a = screen_colour(stops[first]), b = screen_colour(stops[first + 1]);
  return as_light(a + (b - a) * (at - static_cast<double>(first)));
}

Vec3f label_colour(std::uint64_t number) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr std::array<std::pair<double, double>, 3> kTones{
      {{0.62, 0.62}, {0.45, 0.7}, {0.74, 0.5}}};
  const double turned = static_cast<double>(number) * kGolden + 0.58;
  const double hue = 12 * (turned - std::floor(turned));
  const auto [light, strength] = kTones[number % kTones.size()];
  const auto channel = [&, light = light, strength = strength](double shift) {
    const double k = std::fmod(shift + hue, 12);
    return light -
           strength * std::min(light, 1 - light) * std::max(-1.0, std::min({k - 3, 9 - k, 1.0}));
  };
  return as_light({channel(0), channel(8), channel(4)});
}

}  // namespace meshhier::render
