#include "import/material_colours.h"

#include <algorithm>
#include <cmath>

namespace meshhier::importing {

PlainColour PlainColour::of(const images::Material& material) {
  PlainColour colour;
  for (std::size_t c = 0; c < colour.channels.size(); ++c) {
    const float value = std::clamp(material.colour[c], 0.0F, 1.0F);
    colour.channels[c] = static_cast<std::uint8_t>(std::lround(255 * value));
  }
  return colour;
}

}  // namespace meshhier::importing
