#include "texture/chart_map.h"

#include <algorithm>

namespace meshhier::texture {
namespace {

/// Of the middle texel in a mean along an axis, to one of each neighbour.
constexpr float kMiddle = 6;

using Lanes = Vec3<FourFloats>;

Lanes of_length_one(const Lanes& v) {
  const FourFloats squared = dot(v, v), none{};
  return v * (squared > 0.0f ? 1.0f / roots_of(squared) : none);
}

Lanes in_front(const Lanes& coefficients) {
  constexpr float kLeast = 0.05f;
  const Lanes v = of_length_one(coefficients);
  const FourInts is_low = v.z < kLeast;
  if (!any_of(is_low))
    return v;
  const Lanes raised = of_length_one({v.x, v.y, FourFloats{} + kLeast});
  return {is_low ? raised.x : v.x, is_low ? raised.y : v.y, is_low ? raised.z : v.z};
}

Lanes mixed(FourFloats a, FourFloats b, FourFloats c, const std::array<FourFloats, 3>& weights) {
  const auto lane = [&](int axis) {
    return a[axis] * weights[0] + b[axis] * weights[1] + c[axis] * weights[2];
  };
  return {lane(0), lane(1), lane(2)};
}

/// glTF: 0 to 255 are -1 to 1.
FourInts values_of(FourFloats part) {
  const FourFloats low{}, value = (part * 0.5f + 0.5f) * 255.0f + 0.5f;
  const FourFloats most = low + 255.0f;
  const FourFloats cut = value < most ? value : most;
  return __builtin_convertvector(cut > low ? cut : low, FourInts);
}

}  // namespace

void ChartMap::draw(const ChartPlane& plane, images::Image& map) {
  constexpr std::size_t kBehind = 4;  // loads go beyond the last texel
  stride_ = plane.right - plane.left + std::size_t{2};
  const std::size_t size = stride_ * (plane.bottom - plane.top + std::size_t{2}) + kBehind;
  for (std::size_t p = 0; p < kPlanes; ++p) {
    own_[p].assign(size, 0);
    mixed_[p].resize(size);
  }
  for (std::uint32_t y = plane.top; y < plane.bottom; ++y)
    find_row(plane, y);
  mix_rows();
  for (std::uint32_t y = plane.top; y < plane.bottom; ++y)
    draw_row(plane, y, map);
}

void ChartMap::find_row(const ChartPlane& plane, std::uint32_t y) {
  const NormalTexel* row = &directions_[std::size_t{y} * samples_.layout().width];
  for (std::uint32_t x = plane.left; x < plane.right;) {
    Four four;
    four.triangle = samples_.at(x, y).triangle;
    const std::uint32_t first = x;
    for (; x < plane.right && four.count < 4; ++x) {
      const TexelSample& sample = samples_.at(x, y);
      if (sample.triangle != four.triangle)
        break;
      const std::size_t lane = four.count++;
      const CornerWeights weights = weights_of(sample);
      for (std::size_t k = 0; k < 3; ++k)
        four.weights[k][lane] = weights[k];
      four.direction.x[lane] = static_cast<float>(row[x][0]);
      four.direction.y[lane] = static_cast<float>(row[x][1]);
      four.direction.z[lane] = static_cast<float>(row[x][2]);
    }
    if (four.triangle != kNoFace)
      put(four, place(plane, first, y));
  }
}

void ChartMap::put(const Four& four, std::size_t place) {
  const FourVectors found = in_front(coefficients(four));
  for (std::size_t lane = 0; lane < four.count; ++lane) {
    own_[0][place + lane] = found.x[lane];
    own_[1][place + lane] = found.y[lane];
    own_[2][place + lane] = found.z[lane];
    own_[3][place + lane] = 1;
  }
}

/// The directions in frames as viewers have them, each of whose vectors they bring to length 1; of
/// any length.
ChartMap::FourVectors ChartMap::coefficients(const Four& four) const {
  const VertexFrame &a = frames_.at(four.triangle, 0), &b = frames_.at(four.triangle, 1),
                    &c = frames_.at(four.triangle, 2);
  const Lanes tangent = mixed(a.tangent, b.tangent, c.tangent, four.weights);
  const Lanes bitangent = mixed(a.bitangent, b.bitangent, c.bitangent, four.weights);
  const Lanes normal = mixed(a.normal, b.normal, c.normal, four.weights);
  const Lanes of_tangent = cross(bitangent, normal);
  const FourFloats one = FourFloats{} + 1.0f;
  const FourFloats turn = dot(tangent, of_tangent) < 0.0f ? -one : one;
  const auto part = [&](const Lanes& own, const Lanes& across) {
    return roots_of(dot(own, own)) * dot(four.direction, across) * turn;
  };
  return {part(tangent, of_tangent), part(bitangent, cross(normal, tangent)),
          part(normal, cross(tangent, bitangent))};
}

void ChartMap::mix_rows() {
  for (std::size_t p = 0; p < kPlanes; ++p) {
    const float* own = own_[p].data();
    for (std::size_t i = 1; i + 5 <= own_[p].size(); i += 4)
      store_four(&mixed_[p][i],
                 load_four(own + i - 1) + load_four(own + i) * kMiddle + load_four(own + i + 1));
  }
}

/// Away from the mean of its surroundings by two thirds of what it differs from that, a texel comes
/// nearer to the surface.
ChartMap::FourVectors ChartMap::sharpened(std::size_t place) const {
  constexpr float kMore = 0.65f;
  const auto around = [&](std::size_t p) {
    const float* mixed = mixed_[p].data() + place;
    return load_four(mixed - stride_) + load_four(mixed) * kMiddle + load_four(mixed + stride_);
  };
  const FourFloats known = around(3);
  const FourFloats scale = known > 0.0f ? 1.0f / known : known;
  const auto lane = [&](std::size_t p) {
    const FourFloats own = load_four(own_[p].data() + place);
    return own + (own - around(p) * scale) * kMore;
  };
  return {lane(0), lane(1), lane(2)};
}

void ChartMap::draw_row(const ChartPlane& plane, std::uint32_t y, images::Image& map) const {
  for (std::uint32_t x = plane.left; x < plane.right; x += 4) {
    const std::size_t first = place(plane, x, y);
    const FourFloats known = load_four(own_[3].data() + first);
    if (!any_of(known > 0.0f))
      continue;
    const Lanes shown = in_front(sharpened(first));
    const std::array<FourInts, 3> values{values_of(shown.x), values_of(shown.y),
                                         values_of(shown.z)};
    const std::size_t count = std::min<std::size_t>(4, plane.right - x);
    for (std::size_t lane = 0; lane < count; ++lane) {
      if (known[lane] == 0)
        continue;
      std::uint8_t* texel = map.at(x + static_cast<std::uint32_t>(lane), y);
      for (std::size_t k = 0; k < 3; ++k)
        texel[k] = static_cast<std::uint8_t>(values[k][lane]);
    }
  }
}

}  // namespace meshhier::texture
