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
  for (std::size_t k = 0; k < channels_; ++k) {
    const auto summand = [&](const ClippedCorner& c) { return rules_.summand(k, c.attributes[k]); };
    if (!rules_.is_quantity(k))
      made.attributes[k] = static_cast<float>(rules_.number(k, mix(summand)));
  }
  mix_values(from, to, weights, made);
  const std::span<float> all = std::span(made.attributes).first(channels_);
  rules_.normalize(all);
  if (rules_.are_colours_whole()) {
    const std::span<float> colour = rules_.part(AttributeKind::colours).of(all);
    std::ranges::transform(colour, colour.begin(), [](float x) { return std::round(x); });
  }
  return made;
}

void CornerMixer::mix_values(const ClippedCorner& from, std::span<const ClippedCorner* const> to,
                             std::span<const double> weights, ClippedCorner& made) const {
  if (!rules_.values().has_values())
    return;
  std::vector<WeightedVertex> vertices{{from.attributes.data(), 1}};
  for (std::size_t i = 0; i < to.size(); ++i) {
    vertices.push_back({to[i]->attributes.data(), std::max(weights[i], 0.0)});
    vertices[0].weight = std::max(vertices[0].weight - weights[i], 0.0);
  }
  rules_.values().mix(vertices, made.attributes.data());
}

}  // namespace meshhier::exporting
