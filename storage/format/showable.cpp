#include "storage/format/showable.h"

#include "storage/format/tile_plan.h"

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
void make_showable(AttributeRule rule, ColourType colour, std::span<float> channels) {
  if (rule == AttributeRule::direction) {
    const Vec3f normal = showable_normal({channels[0], channels[1], channels[2]});
    channels[0] = normal.x;
    channels[1] = normal.y;
    channels[2] = normal.z;
    return;
  }
  for (float& value : channels) {
    if (rule == AttributeRule::colour)
      value = showable_colour(value, colour);
    else if (!std::isfinite(value))
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
  for (const ChannelGroup& group : groups_of(layout)) {
    for (std::size_t at = group.offset; group.channels > 0 && at < shown.size(); at += channels)
      make_showable(row_of(group.kind).rule, layout.colour,
                    std::span(shown).subspan(at, group.channels));
  }
  return shown;
}

}  // namespace meshhier::storage
