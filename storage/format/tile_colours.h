// Colours as tiles hold them (docs/file_format.md, section 4.7): light, as glTF has it, in numbers
// from which the input's come back.
#pragma once

#include "hierarchy/attributes.h"

#include <cstddef>
#include <vector>

namespace meshhier::storage {

/// What COLOR_0 has of the numbers that the pipeline has.
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

  /// Of COLOR_0; none without colours.
  ColourType stored_type() const;
  /// Its glTF component type.
  unsigned component() const;

  /// Of channel 0 to 3, of a number that showable_attributes() lets stand.
  float stored(float number, std::size_t channel) const;
  /// The inverse, as far as there is one.
  float number(float stored, std::size_t channel) const;
  /// Whether `stored` is what stored() makes of some number.
  bool is_sound(float stored, std::size_t channel) const;

  /// All colours of vertices whose attributes lie one after another.
  std::vector<float> all_stored(std::vector<float> attributes) const;
  std::vector<float> all_numbers(std::vector<float> attributes) const;

 private:
  template <class Change>
  std::vector<float> changed(std::vector<float> attributes, const Change& change) const;

  AttributeLayout layout_;
  bool become_light_;
};

}  // namespace meshhier::storage
