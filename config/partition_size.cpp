#include "config/partition_size.h"

#include <algorithm>

namespace meshhier::config {

std::uint32_t partition_vertices(const Config& config, std::uint64_t places,
                                 std::uint64_t source_texels) {
  constexpr std::uint64_t kPictures = 4;
  constexpr std::uint64_t kFewest = 256;
  const std::uint64_t asked = config.partition.vertices;
  if (source_texels == 0)
    return config.partition.vertices;
  const std::uint64_t side = config.texture.texels;
  const double vertices = static_cast<double>(kPictures * side * side) *
                          static_cast<double>(places) / static_cast<double>(source_texels);
  const double within =
      std::min(static_cast<double>(asked), std::max(static_cast<double>(kFewest), vertices));
  return static_cast<std::uint32_t>(within);
}

}  // namespace meshhier::config
