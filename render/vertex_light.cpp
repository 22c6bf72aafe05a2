#include "render/vertex_light.h"

#include "base/srgb.h"
#include "render/facet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace meshhier::render {
namespace {

/// The light of a number; `full` stands for 1.
double light_of_number(float number, double full, ColourSpace space) {
  if (space == ColourSpace::linear)
    return number > 0 ? std::min(number / full, 1.0) : 0;
  static const std::array<double, 256> bytes = [] {
    std::array<double, 256> lights{};
    for (std::size_t i = 0; i < lights.size(); ++i)
      lights[i] = light_of(static_cast<double>(i) / 255);
    return lights;
  }();
  const bool is_byte = full == 255 && number >= 0 && number <= 255 && number == std::floor(number);
  return is_byte ? bytes[static_cast<std::size_t>(number)] : light_of(number / full);
}

}  // namespace

Vec3f VertexLight::of(std::span<const float> attributes) const {
  if (colours_.count == 0)
    return kPlainColour;
  const auto rgb = colours_.of(attributes);
  const auto light = [&](std::size_t c) { return light_of_number(rgb[c], full_, space_); };
  return to_float({light(0), light(1), light(2)});
}

}  // namespace meshhier::render
