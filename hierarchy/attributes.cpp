#include "hierarchy/attributes.h"

#include "hierarchy/vec.h"

namespace meshhier {

ColourLight::ColourLight(const AttributeLayout& layout)
    : full_(full_number(layout.colour)),
      first_(static_cast<std::size_t>(layout.colour_offset())),
      count_(layout.colour != ColourType::none && layout.space == ColourSpace::srgb ? 3 : 0) {}

void normalize_average(const AttributeLayout& layout, std::span<float> channels) {
  if (!layout.normals)
    return;
  float* n = channels.data() + layout.normal_offset();
  const Vec3d normal{n[0], n[1], n[2]};
  const double size = length(normal);
  if (!(size > 0))
    return;
  for (int axis = 0; axis < 3; ++axis)
    n[axis] = static_cast<float>(normal[axis] / size);
}

}  // namespace meshhier
