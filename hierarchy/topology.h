// Which vertices are one point of the surface.
#pragma once

#include <cstdint>

namespace meshhier {

enum class Topology : std::uint8_t {
  place,  ///< those that lie at one place, whatever their attributes
  index   ///< each is a point of its own
};

}  // namespace meshhier
