// Colours as tiles hold them (docs/file_format.md, section 4.7): light, as glTF has it, in numbers
// from which the input's come back.
#pragma once

#include "hierarchy/attributes.h"

#include <cstddef>
#include <vector>

namespace meshhier::storage {

/// Turns the pipeline's numbers of colours into those of COLOR_0, and back.
///
///   input            COLOR_0
///   sRGB of 8 bits   light of 16 bits; alpha times 257
///   sRGB of 16 bits  light as floats; alpha / 65535
///   sRGB floats      light as floats, of which not all numbers come back bit for bit
///   light            as it is
///
/// Light is rounded to the nearest number.
class TileColours {
 public:
  /// `screen_colours`: tiles of format versions up to 7, which hold the input's numbers as they
  /// are.
  TileColours(const AttributeLayout& layout, bool screen_colours);

  /// Returns the type of COLOR_0; none without colours.
  ColourType stored_type() const;
  /// Returns its glTF component type.
  unsigned component() const;

  /// Returns COLOR_0's number in a channel, 0 to 3, for one that showable_attributes() lets stand.
  float stored(float number, std::size_t channel) const;
  /// Returns the number that stored() was given, as far as it is known.
  float number(float stored, std::size_t channel) const;
  /// Whether `stored` is what stored() makes of some number.
  bool is_sound(float stored, std::size_t channel) const;

  /// These change all colours of vertices whose attributes lie one after another.
  std::vector<float> all_stored(std::vector<float> attributes) const;
  std::vector<float> all_numbers(std::vector<float> attributes) const;

 private:
  template <class Change>
  std::vector<float> changed(std::vector<float> attributes, const Change& change) const;

  ColourType type_;
  AttributePart colours_;
  std::size_t channels_;  ///< of a vertex
  bool become_light_;
};

}  // namespace meshhier::storage
