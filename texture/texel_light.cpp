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

void store_texel(FourFloats mean, std::uint8_t* texel, std::uint32_t channels) {
  const LightTable& table = LightTable::get();
  const float part = mean[3];
  const FourFloats none{}, all = none + 1;
  FourFloats light = mean * (part > 0 ? 1 / part : 0);
  light = light < none ? none : light;
  light = light > all ? all : light;
  const FourInts steps = __builtin_convertvector(light * 65535 + 0.5f, FourInts);
  for (int k = 0; k < 3; ++k)
    texel[k] = table.value(static_cast<std::uint32_t>(steps[k]));
  if (channels == 4)
    texel[3] = value_of_part(std::min(part, 1.0f));
}

}  // namespace meshhier::texture
