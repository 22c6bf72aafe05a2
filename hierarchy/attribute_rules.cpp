#include "hierarchy/attribute_rules.h"

#include "base/vec.h"

#include <array>

namespace meshhier {

AttributeRules::AttributeRules(const AttributeLayout& layout)
    : parts_(layout.parts()),
      full_(full_number(layout.colour)),
      first_(part(AttributeKind::colours).first),
      count_(layout.has_colours() && layout.space == ColourSpace::srgb ? 3 : 0),
      are_colours_light_(layout.space == ColourSpace::linear),
      are_colours_whole_(layout.colour == ColourType::u8 || layout.colour == ColourType::u16),
      values_(layout) {}

void AttributeRules::move(float* to, const float* other, float part) const {
  for (const AttributePart& one : parts_) {
    if (are_quantities(one))
      continue;
    for (std::size_t k = one.first; k < one.end(); ++k) {
      if (!becomes_light(k))
        to[k] = to[k] * (1 - part) + other[k] * part;
      else if (to[k] != other[k])
        to[k] = static_cast<float>(
            number(k, summand(k, to[k]) * (1 - part) + summand(k, other[k]) * part));
    }
  }
  values_.mix(std::array<WeightedVertex, 2>{{{to, 1 - part}, {other, part}}}, to);
}

void AttributeRules::normalize(std::span<float> channels) const {
  for (const AttributePart& part : parts_) {
    if (part.count == 0 || row_of(part.kind).rule != AttributeRule::direction)
      continue;
    const std::span<float> n = part.of(channels);
    const Vec3d normal{n[0], n[1], n[2]};
    const double size = length(normal);
    if (!(size > 0))
      continue;
    for (int axis = 0; axis < 3; ++axis)
      n[static_cast<std::size_t>(axis)] = static_cast<float>(normal[axis] / size);
  }
}

}  // namespace meshhier
