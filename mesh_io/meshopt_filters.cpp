#include "mesh_io/meshopt_filters.h"

#include "base/vec.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace meshhier::mesh_io {
namespace {

constexpr float kQuaternionFull = 32767;
/// What the largest stored component stands for: 1 / sqrt(2), as a float.
constexpr float kQuaternionLargest = 0x1.6a09e6p-1F;

/// The four numbers of an element.
template <class Signed>
struct Element {
  using Stored = std::make_unsigned_t<Signed>;

  std::byte* bytes;

  Signed number(std::size_t i) const {
    return static_cast<Signed>(storage::load_little<Stored>(bytes + i * sizeof(Stored)));
  }
  void store(std::size_t i, float value) {
    const auto whole = static_cast<std::int32_t>(std::nearbyint(value));
    storage::store_little(static_cast<Stored>(whole), bytes + i * sizeof(Stored));
  }
};

/// The direction of a point of the unfolded octahedron |x| + |y| + |z| = `one`.
Vec3f folded(float x, float y, float one) {
  const float z = one - (std::abs(x) + std::abs(y));
  const float beyond = std::min(z, 0.0F);
  return {x - std::copysign(beyond, x), y - std::copysign(beyond, y), z};
}

template <class Signed>
void undo_octahedral_of(Element<Signed> element) {
  const Vec3f p = folded(element.number(0), element.number(1), element.number(2));
  const float squares = p.x * p.x + (p.y * p.y + p.z * p.z);
  const float full = std::numeric_limits<Signed>::max();
  const float scale = squares > 0 ? full / std::sqrt(squares) : 0;
  element.store(0, p.x * scale);
  element.store(1, p.y * scale);
  element.store(2, p.z * scale);
}

void undo_quaternion_of(Element<std::int16_t> element) {
  // The last two bits of the fourth number say which component is missing, its others are the
  // scale.
  const int fourth = element.number(3);
  const float scale = kQuaternionLargest / static_cast<float>(fourth | 3);
  const std::array p{element.number(0) * scale, element.number(1) * scale,
                     element.number(2) * scale};
  const float rest = 1 - (p[0] * p[0] + (p[1] * p[1] + p[2] * p[2]));
  const std::array whole{std::sqrt(std::max(rest, 0.0F)), p[0], p[1], p[2]};
  for (std::size_t i = 0; i < whole.size(); ++i)
    element.store((static_cast<std::size_t>(fourth) + i) % 4, whole[i] * kQuaternionFull);
}

}  // namespace

void undo_octahedral(std::span<std::byte> elements, std::size_t stride) {
  for (std::size_t at = 0; at < elements.size(); at += stride) {
    if (stride == 4 * sizeof(std::int8_t))
      undo_octahedral_of(Element<std::int8_t>{elements.data() + at});
    else
      undo_octahedral_of(Element<std::int16_t>{elements.data() + at});
  }
}

void undo_quaternion(std::span<std::byte> elements) {
  for (std::size_t at = 0; at < elements.size(); at += 4 * sizeof(std::int16_t))
    undo_quaternion_of({elements.data() + at});
}

}  // namespace meshhier::mesh_io
