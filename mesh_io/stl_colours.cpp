#include "mesh_io/stl_colours.h"

#include <algorithm>
#include <string_view>

namespace meshhier::mesh_io {
namespace {

constexpr std::uint16_t kValid = 0x8000;

/// Returns five bits of a number as eight.
std::uint8_t part_of(std::uint16_t attributes, int shift) {
  const int bits = attributes >> shift & 31;
  return static_cast<std::uint8_t>(bits << 3 | bits >> 2);
}

}  // namespace

std::optional<StlColour> stl_header_colour(std::span<const std::byte> header) {
  constexpr std::string_view kWord = "COLOR=";
  constexpr std::size_t kNumbers = 4;
  const std::string_view text(reinterpret_cast<const char*>(header.data()), header.size());
  const std::size_t at = text.find(kWord);
  if (at == std::string_view::npos || at + kWord.size() + kNumbers > text.size())
    return std::nullopt;
  const auto part = [&](std::size_t i) {
    return static_cast<std::uint8_t>(text[at + kWord.size() + i]);
  };
  return StlColour{part(0), part(1), part(2)};
}

void StlColours::add(std::span<const std::uint16_t> attributes) {
  for (const std::uint16_t number : attributes) {
    has_number_ = has_number_ || number != 0;
    has_colour_ = has_colour_ || number > kValid;
    has_other_ = has_other_ || (number != 0 && number < kValid);
  }
}

std::optional<StlColour> StlColours::colour_of(std::uint16_t attributes) const {
  const bool has_bit = (attributes & kValid) != 0;
  // If all are 0, nobody has chosen black.
  if (whole_ && (has_bit || !has_number_))
    return whole_;
  if (whole_)
    return StlColour{part_of(attributes, 0), part_of(attributes, 5), part_of(attributes, 10)};
  if (!has_bit)
    return std::nullopt;
  return StlColour{part_of(attributes, 10), part_of(attributes, 5), part_of(attributes, 0)};
}

}  // namespace meshhier::mesh_io
