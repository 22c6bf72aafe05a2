// All that kernels know of attributes: which channels there are, how those of several vertices
// become those of one, and which of two vertices are different. Everything follows from the rules
// of the layout's kinds (attributes.h).
#pragma once

#include "base/srgb.h"
#include "hierarchy/attributes.h"
#include "hierarchy/value_mixer.h"

#include <algorithm>
#include <cstddef>
#include <span>

namespace meshhier {

class AttributeRules {
 public:
  AttributeRules(const AttributeLayout& layout = {});  // NOLINT(google-explicit-constructor)

  const AttributeParts& parts() const { return parts_; }
  const AttributePart& part(AttributeKind kind) const { return part_of(parts_, kind); }
  std::size_t channels() const { return parts_.back().end(); }
  /// Colours are numbers from 0 to this.
  double full() const { return full_; }
  /// Colours are numbers of light, not those of a screen.
  bool are_colours_light() const { return are_colours_light_; }
  /// Colours are whole numbers.
  bool are_colours_whole() const { return are_colours_whole_; }

  /// Mixes quantities; summand() and number() are for all other channels.
  const ValueMixer& values() const { return values_; }
  static bool are_quantities(const AttributePart& part) {
    return row_of(part.kind).rule == AttributeRule::quantities;
  }
  bool is_quantity(std::size_t channel) const {
    return std::ranges::any_of(parts_, [&](const AttributePart& part) {
      return are_quantities(part) && part.has(channel);
    });
  }

  /// The number of a channel in the units in which means are taken: of colours their light, 0 to 1;
  /// what is outside is cut.
  double summand(std::size_t channel, double number) const {
    return becomes_light(channel) ? curve_.light(number / full_) : number;
  }
  /// The inverse, but for rounding.
  double number(std::size_t channel, double mean) const {
    return becomes_light(channel) ? full_ * curve_.value(mean) : mean;
  }

  /// Makes `to` the attributes at a part of the way from it to `other`, 0 to 1; directions lose
  /// their length. `to`, `other`: channels() floats.
  void move(float* to, const float* other, float part) const;

  /// Makes an average of attribute vectors an attribute vector again: directions to unit length (a
  /// zero one stays zero); the rest unchanged. `channels`: channels() floats of one vertex.
  void normalize(std::span<float> channels) const;

 private:
  /// Whether means of a channel are not means of its numbers.
  bool becomes_light(std::size_t channel) const { return channel - first_ < count_; }

  const LightCurve& curve_ = LightCurve::get();
  AttributeParts parts_;
  double full_;
  std::size_t first_, count_;  ///< of the channels that become light
  bool are_colours_light_, are_colours_whole_;
  ValueMixer values_;
};

}  // namespace meshhier
