// Paints tiles in the colours of one of their attributes.
#pragma once

#include "hierarchy/published.h"
#include "hierarchy/value_channels.h"
#include "render/colour_ramp.h"
#include "render/scene.h"

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::render {

struct AttributeColours {
  std::string attribute;
  std::optional<ColourRamp> ramp{};  ///< none: coolwarm for signed values, else viridis
  /// Values at the ends of the ramp; none: the least and the most, on both sides of 0 if coolwarm.
  std::optional<std::array<double, 2>> range{};
  /// Values not farther from 0 have the plain colour; the ramp begins outside.
  std::optional<double> tolerance{};
  std::vector<double> hidden{};  ///< labels that are not drawn
};

/// Gives tiles colours by an attribute. Thread-safe once constructed.
class AttributePainter {
 public:
  /// Throws Error(usage) if the source has no such attribute: the message lists those that there
  /// are.
  AttributePainter(const SourceSummary& source, const AttributeColours& colours);
  /// The colour of an object, as light; none: it has no value.
  using ObjectColour = std::function<std::optional<Vec3f>(double object)>;
  /// Paints objects in colours of their own.
  AttributePainter(const AttributeLayout& given, ObjectColour colour);

  /// Returns the attributes of painted tiles.
  const AttributeLayout& layout() const { return painted_; }
  /// Gives the tile's vertices colours instead of all else but normals, and takes its picture.
  /// Where there is no finite value they are grey; of hidden labels they are no numbers, for
  /// drop_hidden(). O(n).
  void paint(PublishedTile& tile) const;

 private:
  void begin_painted();
  void paint(VertexArray& vertices) const;
  Vec3f colour(double value) const;

  AttributeLayout given_, painted_;
  PlacedValue value_;
  ColourRamp ramp_{};
  std::array<double, 2> range_{};
  double tolerance_ = -1;
  std::vector<double> hidden_;
  ObjectColour object_colour_;              ///< empty: it is an attribute
  std::map<double, std::uint64_t> labels_;  ///< numbers of labels, by value
};

/// Takes the facets away whose last corner has no colour: they are of hidden labels. O(n).
void drop_hidden(SceneTile& tile);

}  // namespace meshhier::render
