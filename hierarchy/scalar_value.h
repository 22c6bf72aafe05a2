// Numbers that a vertex has besides normal, colour and texture coordinates: quality, label,
// temperature. Their types, and how they lie in float channels.
//
// Integers of up to 16 bits and floats take one channel, in which they are exact. The wider types
// take two: the upper and the lower half of a double's bits. So every value comes back bit for bit;
// arithmetic goes through value_in() and put_value().
#pragma once

#include "base/named_value.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier {

enum class ValueType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

constexpr bool is_integer(ValueType type) {
  return type < ValueType::f32;
}
constexpr bool takes_two_channels(ValueType type) {
  return type == ValueType::i32 || type == ValueType::u32 || type == ValueType::f64;
}
constexpr int channels_of(ValueType type) {
  return takes_two_channels(type) ? 2 : 1;
}
/// "u8", "f64".
std::string_view name_of(ValueType type);
std::optional<ValueType> value_type_of(std::string_view name);

/// An attribute with one number a vertex.
struct ScalarAttribute {
  std::string name;  ///< of the input: 1 to kMostNameBytes printable ASCII characters, no space
  ValueType type{};
  /// Names something, as an object or a class: is never averaged. Otherwise it is a quantity.
  bool is_label = false;
  /// Is a label that says which object a triangle belongs to: its corners have the same one, in
  /// every tile. A mesh has one such value at most, of the type u32.
  bool is_object = false;
  friend bool operator==(const ScalarAttribute&, const ScalarAttribute&) = default;
};

enum class ValueKind : std::uint8_t { quantity, label, object };
inline constexpr std::array kValueKinds{NamedValue{"quantity", ValueKind::quantity},
                                        NamedValue{"label", ValueKind::label},
                                        NamedValue{"object", ValueKind::object}};

inline ValueKind kind_of(const ScalarAttribute& attribute) {
  return attribute.is_object  ? ValueKind::object
         : attribute.is_label ? ValueKind::label
                              : ValueKind::quantity;
}
inline void set_kind(ScalarAttribute& attribute, ValueKind kind) {
  attribute.is_label = kind != ValueKind::quantity;
  attribute.is_object = kind == ValueKind::object;
}

inline constexpr std::size_t kMostNameBytes = 100;
bool is_attribute_name(std::string_view name);

/// The value whose channels begin at `channels`. All types are exact in a double.
double value_in(ValueType type, const float* channels);
/// The inverse, for values that are of the type. Means of integers need not be: they are kept as
/// floats, or as doubles.
void put_value(ValueType type, double value, float* channels);

/// The nearest value of a type; of what is no number 0 if the type is an integer's.
double of_type(ValueType type, double value);

}  // namespace meshhier
