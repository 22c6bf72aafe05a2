// Paints tiles in the colours of one of their attributes.
#pragma once

#include "hierarchy/published.h"
#include "inspection/object_colours.h"
#include "render/colour_ramp.h"

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace meshhier::inspection {

struct AttributeColours {
  std::string attribute;
  std::optional<render::ColourRamp> ramp{};  ///< none: coolwarm for signed values, else viridis
  /// Values at the ends of the ramp; none: the least and the most, on both sides of 0 if coolwarm.
  std::optional<std::array<double, 2>> range{};
};

/// Gives tiles colours by an attribute. Thread-safe once constructed.
class AttributePainter {
 public:
  /// Throws Error(usage) if the source has no such attribute: the message lists those that there
  /// are.
  AttributePainter(const SourceSummary& source, const AttributeColours& colours);
  /// Paints objects in colours of their own.
  AttributePainter(const AttributeLayout& given, ObjectColours colours);

  /// Returns for people what the colours of objects mean; nothing of an attribute's.
  std::string legend() const { return objects_ ? objects_->legend() : ""; }

  /// Returns the attributes of painted tiles.
  const AttributeLayout& layout() const { return painted_; }
  /// Gives the tile's vertices colours instead of all else but normals, and takes its picture.
  /// Where there is no finite value they are grey. O(n).
  void paint(PublishedTile& tile) const;

 private:
  void begin_painted();
  void paint(VertexArray& vertices) const;
  Vec3f colour(double value) const;

  AttributeLayout given_, painted_;
  ScalarAttribute attribute_;
  std::size_t channel_ = 0;  ///< the attribute's first channel
  render::ColourRamp ramp_{};
  std::array<double, 2> range_{};
  std::optional<ObjectColours> objects_;
  std::map<double, std::uint64_t> labels_;  ///< numbers of labels, by value
};

}  // namespace meshhier::inspection
