#include "export/clipped_corner.h"

#include <algorithm>
#include <cmath>

namespace meshhier::exporting {
namespace {

Vec3f unit(Vec3f v, Vec3f otherwise) {
  const Vec3d wide = to_double(v);
  const double size = length(wide);
  return size > 0 ? to_float(wide * (1 / size)) : otherwise;
}

}  // namespace

ClippedCorner CornerMixer::mixed(const ClippedCorner& from,
                                 std::span<const ClippedCorner* const> to,
                                 std::span<const double> weights) const {
  /// `number(corner)` of all, mixed.
  const auto mix = [&](const auto& number) {
    const double begin = number(from);
    double sum = begin;
    for (std::size_t i = 0; i < to.size(); ++i)
      sum += (number(*to[i]) - begin) * weights[i];
    return sum;
  };
  const auto mix_float = [&](const auto& number) {
    return static_cast<float>(mix([&](const ClippedCorner& c) { return double{number(c)}; }));
  };
  const auto mix_vector = [&](Vec3f ClippedCorner::*vector) {
    return Vec3f{mix_float([=](const ClippedCorner& c) { return (c.*vector).x; }),
                 mix_float([=](const ClippedCorner& c) { return (c.*vector).y; }),
                 mix_float([=](const ClippedCorner& c) { return (c.*vector).z; })};
  };
  ClippedCorner made;
  made.position = mix_vector(&ClippedCorner::position);
  made.normal = unit(mix_vector(&ClippedCorner::normal), from.normal);
  made.texcoord = {mix_float([](const ClippedCorner& c) { return c.texcoord.u; }),
                   mix_float([](const ClippedCorner& c) { return c.texcoord.v; })};
  const auto first_value = static_cast<std::size_t>(layout_.value_offset());
  const auto behind_values = static_cast<std::size_t>(layout_.texcoord_offset());
  for (std::size_t channel = 0; channel < channels_; ++channel) {
    if (channel >= first_value && channel < behind_values)
      continue;
    const auto number = [=](const ClippedCorner& c) { return c.attributes[channel]; };
    made.attributes[channel] =
        light_.has(channel) ? static_cast<float>(light_.number(mix(
                                  [&](const ClippedCorner& c) { return light_.light(number(c)); })))
                            : mix_float(number);
  }
  mix_values(from, to, weights, made);
  normalize_average(layout_, std::span(made.attributes).first(channels_));
  if (layout_.colour == ColourType::none || layout_.colour == ColourType::f32)
    return made;
  const auto colour = std::span(made.attributes)
                          .subspan(static_cast<std::size_t>(layout_.colour_offset()),
                                   static_cast<std::size_t>(layout_.colour_channels()));
  std::ranges::transform(colour, colour.begin(), [](float x) { return std::round(x); });
  return made;
}

void CornerMixer::mix_values(const ClippedCorner& from, std::span<const ClippedCorner* const> to,
                             std::span<const double> weights, ClippedCorner& made) const {
  if (!values_.has_values())
    return;
  std::vector<WeightedVertex> vertices{{from.attributes.data(), 1}};
  for (std::size_t i = 0; i < to.size(); ++i) {
    vertices.push_back({to[i]->attributes.data(), std::max(weights[i], 0.0)});
    vertices[0].weight = std::max(vertices[0].weight - weights[i], 0.0);
  }
  values_.mix(vertices, made.attributes.data());
}

}  // namespace meshhier::exporting
