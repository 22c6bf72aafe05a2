#include "storage/format/showable.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace meshhier::storage {
namespace {

Vec3f showable_normal(Vec3f normal) {
  if (is_unit_normal(normal))
    return normal;
  const Vec3d wide = to_double(normal);
  const double size = length(wide);
  if (!(size > 0) || !std::isfinite(size))
    return {0, 0, 1};
  return to_float(wide * (1 / size));
}

float showable_colour(float value, ColourType type) {
  if (std::isnan(value))
    return 0;
  if (type == ColourType::f32)
    return std::clamp(value, 0.0F, 1.0F);
  // Adding 0 makes +0 of -0, which integer types do not have.
  return std::clamp(std::round(value), 0.0F, full_number(type)) + 0.0F;
}

/// Turns one vertex's attributes into what the standard glTF accessors hold.
void make_showable(const AttributeLayout& layout, std::span<float> channels) {
  if (layout.normals) {
    float* n = channels.data() + layout.normal_offset();
    const Vec3f normal = showable_normal({n[0], n[1], n[2]});
    n[0] = normal.x;
    n[1] = normal.y;
    n[2] = normal.z;
  }
  for (int i = 0; i < layout.colour_channels(); ++i) {
    float& value = channels[static_cast<std::size_t>(layout.colour_offset() + i)];
    value = showable_colour(value, layout.colour);
  }
  for (int i = 0; layout.texcoords && i < 2; ++i) {
    float& value = channels[static_cast<std::size_t>(layout.texcoord_offset() + i)];
    if (!std::isfinite(value))
      value = 0;
  }
}

}  // namespace

bool is_unit_normal(Vec3f normal) {
  constexpr double kTolerance = 0.001;  // the validator's is 0.00674, in single precision
  return std::abs(length(to_double(normal)) - 1) <= kTolerance;
}

std::vector<float> showable_attributes(const AttributeLayout& layout, const VertexArray& vertices) {
  std::vector<float> shown = vertices.attributes;
  const auto channels = static_cast<std::size_t>(layout.channels());
  for (std::size_t v = 0; channels > 0 && v < vertices.size(); ++v) {
    make_showable(layout, std::span(shown).subspan(v * channels, channels));
  }
  return shown;
}

}  // namespace meshhier::storage
