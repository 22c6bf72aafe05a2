#include "cluster_simplify/attribute_kind.h"

#include "hierarchy/angle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meshhier::cluster_simplify {
namespace {

// How far a direction may seem to be from itself, by rounding: 1 - cosine.
constexpr double kSameDirection = 1e-12;

double light_of_value(double value) {
  return LightCurve::get().light(value);
}
double screen_value_of(double light) {
  return LightCurve::get().value(light);
}

double squared_sum(const AttributePoint& p) {
  return p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3];
}

AttributePoint scaled(const AttributePoint& p, double scale) {
  return {p[0] * scale, p[1] * scale, p[2] * scale, p[3] * scale};
}

std::optional<AttributePoint> direction(const AttributePoint& p) {
  const double size = std::sqrt(squared_sum(p));
  if (!(size > 0) || !std::isfinite(size))
    return std::nullopt;
  return scaled(p, 1 / size);
}

}  // namespace

AttributeKind AttributeKind::normals(const AttributeLayout& layout, const WedgeOptions& options) {
  const double cosine = turn_by(options.crease_angle * std::numbers::pi / 180).cosine;
  return {static_cast<std::size_t>(layout.normal_offset()), std::size_t{layout.normals ? 3U : 0U},
          Numbers::directions, 1, 1 - cosine + kSameDirection};
}

AttributeKind AttributeKind::colours(const AttributeLayout& layout, const WedgeOptions& options) {
  const double range = full_number(layout.colour);
  return {static_cast<std::size_t>(layout.colour_offset()),
          static_cast<std::size_t>(layout.colour_channels()),
          layout.space == ColourSpace::linear ? Numbers::light : Numbers::values, range,
          options.colour_tolerance * range};
}

std::optional<AttributePoint> AttributeKind::point(std::span<const float> part) const {
  AttributePoint p{};
  std::copy(part.begin(), part.end(), p.begin());
  if (numbers_ == Numbers::directions)
    return direction(p);
  if (!std::isfinite(squared_sum(p)))
    return std::nullopt;
  return numbers_ == Numbers::light ? changed(p, screen_value_of) : p;
}

double AttributeKind::distance(const AttributePoint& a, const AttributePoint& b) const {
  if (numbers_ == Numbers::directions)
    return 1 - (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

bool AttributeKind::are_apart(std::span<const float> a, std::span<const float> b) const {
  const std::optional<AttributePoint> p = point(a);
  const std::optional<AttributePoint> q = point(b);
  return p && q && distance(*p, *q) > limit_;
}

AttributePoint AttributeKind::summand(const AttributePoint& point) const {
  if (numbers_ == Numbers::directions)
    return point;
  return changed(point, light_of_value);
}

std::optional<AttributePoint> AttributeKind::mean(const AttributePoint& sum, double weight) const {
  if (numbers_ == Numbers::directions)
    return direction(sum);
  if (!(weight > 0))
    return std::nullopt;
  const AttributePoint mean = scaled(sum, 1 / weight);
  if (numbers_ == Numbers::light)
    return mean;
  return changed(mean, screen_value_of);
}

double squared_difference(const AttributeLayout& layout, std::span<const float> a,
                          std::span<const float> b) {
  const auto colours = static_cast<std::size_t>(layout.colour_offset());
  const auto after = static_cast<std::size_t>(layout.value_offset());
  const auto behind_values = static_cast<std::size_t>(layout.texcoord_offset());
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (k >= after && k < behind_values)
      continue;
    const double range = k >= colours && k < after ? double{full_number(layout.colour)} : 1;
    const double difference = (double{a[k]} - double{b[k]}) / range;
    sum += difference * difference;
  }
  return sum;
}

}  // namespace meshhier::cluster_simplify
