#include "render/attribute_painter.h"

#include "base/error.h"
#include "base/plain_text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace meshhier::render {
namespace {

constexpr Vec3f kNoValueColour{0.2F, 0.2F, 0.2F};
constexpr float kHidden = std::numeric_limits<float>::quiet_NaN();

[[noreturn]] void refuse_name(const SourceSummary& source, const std::string& name) {
  std::string names;
  for (const ScalarAttribute& value : source.attributes.values)
    names += (names.empty() ? "the hierarchy has " : ", ") + value.name;
  if (names.empty())
    names = "the hierarchy has no attributes besides colours";
  throw Error(ErrorCode::usage, "--attribute " + plain_text(name, kMostNameBytes) + ": " + names);
}

std::array<double, 2> whole_range(const ValueStatistics& values, ColourRamp ramp) {
  if (ramp != ColourRamp::coolwarm || values.min >= 0 || values.max <= 0)
    return {values.min, values.max};
  const double most = std::max(-values.min, values.max);
  return {-most, most};
}

}  // namespace

AttributePainter::AttributePainter(const SourceSummary& source, const AttributeColours& colours)
    : given_(source.attributes) {
  const auto found = std::ranges::find(given_.values, colours.attribute, &ScalarAttribute::name);
  if (found == given_.values.end())
    refuse_name(source, colours.attribute);
  const auto number = static_cast<std::size_t>(found - given_.values.begin());
  const ValueStatistics& values = source.values[number];
  value_ = placed_values(given_)[number];
  const bool is_signed = values.min < 0 && values.max > 0;
  ramp_ = colours.ramp.value_or(is_signed ? ColourRamp::coolwarm : ColourRamp::viridis);
  range_ = colours.range.value_or(whole_range(values, ramp_));
  tolerance_ = colours.tolerance.value_or(-1);
  hidden_ = colours.hidden;
  for (const auto& label : values.labels)
    labels_.emplace(label.label, labels_.size());
  begin_painted();
}

AttributePainter::AttributePainter(const AttributeLayout& given, ObjectColour colour)
    : given_(given), object_colour_(std::move(colour)) {
  value_ = placed_object(given_).value();
  begin_painted();
}

void AttributePainter::begin_painted() {
  painted_.normals = given_.normals;
  painted_.colour = ColourType::f32;
  painted_.space = ColourSpace::linear;
}

void AttributePainter::paint(PublishedTile& tile) const {
  paint(tile.mesh.vertices);
  paint(tile.mesh.copies.vertices);
  if (tile.normal_map.empty())
    drop_pictures(tile);
  tile.image = {};
}

void AttributePainter::paint(VertexArray& vertices) const {
  std::vector<float> painted;
  painted.reserve(vertices.size() * static_cast<std::size_t>(painted_.channels()));
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const auto channels = vertices.attributes_of(v);
    const auto normal = given_.part(AttributeKind::normals).of(channels);
    painted.insert(painted.end(), normal.begin(), normal.end());
    const Vec3f rgb = colour(value_.in(channels.data()));
    painted.insert(painted.end(), {rgb.x, rgb.y, rgb.z});
  }
  vertices.attributes = std::move(painted);
  vertices.channels = painted_.channels();
}

Vec3f AttributePainter::colour(double value) const {
  if (object_colour_)
    return object_colour_(value).value_or(kNoValueColour);
  if (!std::isfinite(value))
    return kNoValueColour;
  if (value_.is_label) {
    if (std::ranges::find(hidden_, value) != hidden_.end())
      return {kHidden, kHidden, kHidden};
    const auto known = labels_.find(value);
    return label_colour(known != labels_.end()
                            ? known->second
                            : static_cast<std::uint64_t>(std::min(std::abs(value), 1e15)));
  }
  if (std::abs(value) <= tolerance_)
    return kPlainColour;
  // What is within the tolerance is cut out of the axis.
  const auto beyond = [&](double one) {
    return tolerance_ > 0 ? one - std::clamp(one, -tolerance_, tolerance_) : one;
  };
  const double from = beyond(range_[0]), width = beyond(range_[1]) - from;
  return ramp_colour(ramp_, (beyond(value) - from) / (width == 0 ? 1 : width));  // as the page
}

void drop_hidden(SceneTile& tile) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tile.facets.size(); ++i) {
    if (std::isnan(tile.facets[i][2].colour.x))
      continue;
    tile.facets[kept] = tile.facets[i];
    if (!tile.skins.empty())
      tile.skins[kept] = tile.skins[i];
    ++kept;
  }
  tile.facets.resize(kept);
  if (!tile.skins.empty())
    tile.skins.resize(kept);
}

}  // namespace meshhier::render
