#include "cluster_simplify/attribute_metric.h"

#include "base/angle.h"

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

AttributeMetric::AttributeMetric(const AttributePart& part, const AttributeRules& rules,
                                 const WedgeOptions& options)
    : channels_(part),
      are_directions_(row_of(part.kind).rule == AttributeRule::direction),
      are_light_(rules.are_colours_light()),
      range_(are_directions_ ? 1 : rules.full()),
      limit_(options.colour_tolerance * range_) {
  if (are_directions_)
    limit_ = 1 - turn_by(options.crease_angle * std::numbers::pi / 180).cosine + kSameDirection;
}

std::optional<AttributePoint> AttributeMetric::point(std::span<const float> part) const {
  AttributePoint p{};
  std::copy(part.begin(), part.end(), p.begin());
  if (are_directions_)
    return direction(p);
  if (!std::isfinite(squared_sum(p)))
    return std::nullopt;
  return are_light_ ? changed(p, screen_value_of) : p;
}

double AttributeMetric::distance(const AttributePoint& a, const AttributePoint& b) const {
  if (are_directions_)
    return 1 - (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

bool AttributeMetric::are_apart(std::span<const float> a, std::span<const float> b) const {
  const std::optional<AttributePoint> p = point(part(a));
  const std::optional<AttributePoint> q = point(part(b));
  return p && q && distance(*p, *q) > limit_;
}

AttributePoint AttributeMetric::summand(const AttributePoint& point) const {
  if (are_directions_)
    return point;
  return changed(point, light_of_value);
}

std::optional<AttributePoint> AttributeMetric::mean(const AttributePoint& sum,
                                                    double weight) const {
  if (are_directions_)
    return direction(sum);
  if (!(weight > 0))
    return std::nullopt;
  const AttributePoint mean = scaled(sum, 1 / weight);
  if (are_light_)
    return mean;
  return changed(mean, screen_value_of);
}

std::vector<AttributeMetric> metrics_of(const AttributeRules& rules, const WedgeOptions& options) {
  std::vector<AttributeMetric> metrics;
  for (const AttributePart& part : rules.parts()) {
    if (part.count > 0 && is_measured(row_of(part.kind)))
      metrics.emplace_back(part, rules, options);
  }
  return metrics;
}

double squared_difference(const AttributeRules& rules, std::span<const float> a,
                          std::span<const float> b) {
  double sum = 0;
  for (const AttributePart& part : rules.parts()) {
    if (AttributeRules::are_quantities(part))
      continue;
    const double range = part.kind == AttributeKind::colours ? rules.full() : 1;
    for (std::size_t k = part.first; k < part.end(); ++k) {
      const double difference = (double{a[k]} - double{b[k]}) / range;
      sum += difference * difference;
    }
  }
  return sum;
}

}  // namespace meshhier::cluster_simplify
