#include "storage/format/tile_colours.h"

#include "base/srgb.h"
#include "storage/format/glb.h"

#include <cmath>
#include <cstdint>
#include <utility>

namespace meshhier::storage {
namespace {

constexpr std::size_t kAlpha = 3;
constexpr float kFullShort = 65535;
constexpr float kShortsAByte = 257;

}  // namespace

TileColours::TileColours(const AttributeLayout& layout, bool screen_colours)
    : type_(layout.colour),
      colours_(layout.part(AttributeKind::colours)),
      channels_(static_cast<std::size_t>(layout.channels())),
      become_light_(!screen_colours && layout.space == ColourSpace::srgb && layout.has_colours()) {}

ColourType TileColours::stored_type() const {
  if (!become_light_)
    return type_;
  return type_ == ColourType::u8 ? ColourType::u16 : ColourType::f32;
}

unsigned TileColours::component() const {
  const ColourType type = stored_type();
  return type == ColourType::u8 ? kU8 : type == ColourType::u16 ? kU16 : kF32;
}

float TileColours::stored(float number, std::size_t channel) const {
  if (!become_light_)
    return number;
  if (type_ == ColourType::u8) {
    return channel == kAlpha
               ? number * kShortsAByte
               : static_cast<float>(LightTable::get().light(static_cast<std::uint8_t>(number)));
  }
  const float part = type_ == ColourType::u16 ? number / kFullShort : number;
  return channel == kAlpha ? part : static_cast<float>(light_of(part));
}

float TileColours::number(float stored, std::size_t channel) const {
  if (!become_light_)
    return stored;
  if (type_ == ColourType::u8) {
    return channel == kAlpha
               ? std::floor(stored / kShortsAByte)
               : static_cast<float>(LightTable::get().value(static_cast<std::uint32_t>(stored)));
  }
  const double part = channel == kAlpha ? double{stored} : value_of(stored);
  return static_cast<float>(type_ == ColourType::u16 ? std::round(part * kFullShort) : part);
}

bool TileColours::is_sound(float stored_number, std::size_t channel) const {
  return !become_light_ || type_ != ColourType::u8 ||
         stored(number(stored_number, channel), channel) == stored_number;
}

template <class Change>
std::vector<float> TileColours::changed(std::vector<float> attributes, const Change& change) const {
  for (std::size_t v = colours_.first; become_light_ && v < attributes.size(); v += channels_) {
    for (std::size_t c = 0; c < colours_.count; ++c)
      attributes[v + c] = change(attributes[v + c], c);
  }
  return attributes;
}

std::vector<float> TileColours::all_stored(std::vector<float> attributes) const {
  return changed(std::move(attributes), [&](float x, std::size_t c) { return stored(x, c); });
}

std::vector<float> TileColours::all_numbers(std::vector<float> attributes) const {
  return changed(std::move(attributes), [&](float x, std::size_t c) { return number(x, c); });
}

}  // namespace meshhier::storage
