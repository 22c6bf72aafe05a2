#include "texture/texel_light.h"

#include "base/srgb.h"

#include <algorithm>
#include <cstddef>

namespace meshhier::texture {

const std::array<float, 256> kLight = [] {
  std::array<float, 256> lights{};
  for (std::size_t i = 0; i < lights.size(); ++i)
    lights[i] = static_cast<float>(light_of(static_cast<double>(i) / 255));
  return lights;
}();

std::uint8_t value_of_light(float light) {
  const float steps = std::clamp(light, 0.0f, 1.0f) * 65535;
  return LightTable::get().value(static_cast<std::uint32_t>(steps + 0.5f));
}

}  // namespace meshhier::texture
