// The range of the numbers that the colours of a mesh have: some programs write bytes in a wider
// type.
#pragma once

#include "hierarchy/attributes.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

namespace meshhier::pipeline {

class ColourRange {
 public:
  /// `attributes`: the channels of vertices, one vertex after another.
  void add(std::span<const float> attributes, const AttributeLayout& layout) {
    const auto vertex = static_cast<std::size_t>(layout.channels());
    const auto first = layout.part(AttributeKind::colours).first;
    const auto count = layout.part(AttributeKind::colours).count;
    if (count == 0 || layout.colour == ColourType::u8)
      return;
    for (std::size_t v = first; v < attributes.size(); v += vertex) {
      for (std::size_t c = 0; c < count; ++c) {
        least_ = std::min(least_, attributes[v + c]);
        most_ = std::max(most_, attributes[v + c]);
      }
    }
  }
  void add(const ColourRange& other) {
    least_ = std::min(least_, other.least_);
    most_ = std::max(most_, other.most_);
  }

  float most() const { return most_; }
  /// Whether they are 8-bit colours in another type: 16-bit numbers of at most 255, which would all
  /// be black; floats from 0 to 255 that go beyond 2, which would nearly all be white. Light may be
  /// so dark, or bright.
  bool are_bytes(const AttributeLayout& layout) const {
    constexpr float kMost = 255, kMostLight = 2;
    if (layout.space == ColourSpace::linear || !(least_ >= 0 && most_ <= kMost))
      return false;
    return layout.colour == ColourType::u16   ? most_ > 0
           : layout.colour == ColourType::f32 ? most_ > kMostLight
                                              : false;
  }

 private:
  float least_ = std::numeric_limits<float>::infinity();
  float most_ = -std::numeric_limits<float>::infinity();
};

}  // namespace meshhier::pipeline
