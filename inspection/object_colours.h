// A colour for each object by one of its properties: numbers along a ramp, other values each its
// own, those of many objects first.
#pragma once

#include "base/vec.h"
#include "execution/cancel.h"
#include "render/colour_ramp.h"
#include "storage/format/object_table.h"

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::inspection {

struct ObjectColouring {
  std::string property;                      ///< or a fact of all: name, area, triangles
  std::optional<render::ColourRamp> ramp{};  ///< none: coolwarm for signed values, else viridis
  /// Values at the ends of the ramp; none: the least and the most, on both sides of 0 if coolwarm.
  std::optional<std::array<double, 2>> range{};
};

/// Thread-safe once constructed. Memory: 4 bytes an object, and the different values.
class ObjectColours {
 public:
  /// Reads the table twice. Throws Error(usage) if there is no such property, or if its values are
  /// no numbers and more than 65,536 different ones, or if ramp or range are given for those;
  /// Error(io | corrupt | interrupted).
  ObjectColours(const storage::ObjectTable& table, const ObjectColouring& colouring,
                const execution::CancelToken& cancel);

  /// Returns the colour of an object as light; nothing if it has no value.
  std::optional<Vec3f> colour(double object) const;
  /// Returns for people what the colours mean, some lines.
  const std::string& legend() const { return legend_; }

  struct NumberRange {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    std::uint32_t missing = 0;  ///< objects without a value
  };

 private:
  /// Gives all objects the shades of their values.
  using ShadeAll = std::function<void(const std::function<float(const ObjectValue& value)>&)>;

  void by_numbers(const NumberRange& all, const ObjectColouring& colouring,
                  const ShadeAll& shade_all);
  /// `counts`: how many objects have a value.
  void by_categories(const std::map<ObjectValue, std::uint32_t>& counts,
                     const ObjectColouring& colouring, const ShadeAll& shade_all);

  bool is_number_ = false;
  render::ColourRamp ramp_{};
  /// Each object has its part of the way along the ramp, or the number of its colour; NaN if it has
  /// no value.
  std::vector<float> shades_;
  std::string legend_;
};

}  // namespace meshhier::inspection
