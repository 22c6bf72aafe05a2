// Colours of the facets of binary STL files, which two programs write in the two bytes that a facet
// has left.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace meshhier::mesh_io {

using StlColour = std::array<std::uint8_t, 3>;  ///< red, green, blue

/// Returns the colour of the whole mesh that Materialise Magics writes into the header: "COLOR="
/// and four bytes.
std::optional<StlColour> stl_header_colour(std::span<const std::byte> header);

/// Finds out what the last two bytes of facets mean:
///
///   VisCAM, SolidView   bit 15 is set: the facet has a colour; bits 0 to 4 are blue, 5 to 9 green,
///                       10 to 14 red
///   Magics              the header has a colour. Bit 15 is set: the facet has that; else red,
///                       green and blue in this order
///
/// The format gives them no meaning, so other programs write other things: without a colour in the
/// header, files whose facets have numbers without bit 15, or no number but black, have no colours.
class StlColours {
 public:
  void set_header(std::optional<StlColour> colour) { whole_ = colour; }
  void add(std::span<const std::uint16_t> attributes);

  /// Returns whether there are colours. Requires that all facets were added.
  bool any() const { return whole_ ? true : has_colour_ && !has_other_; }
  /// Returns a facet's colour; none: it has no colour beside others that have. Requires any().
  std::optional<StlColour> colour_of(std::uint16_t attributes) const;

 private:
  std::optional<StlColour> whole_;
  bool has_number_ = false;  ///< a number that is not 0
  bool has_colour_ = false;  ///< bit 15, and not black
  bool has_other_ = false;   ///< a number without bit 15
};

}  // namespace meshhier::mesh_io
