#include "hierarchy/scalar_value.h"

#include "base/named_value.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace meshhier {
namespace {

constexpr std::array kTypes{NamedValue{"i8", ValueType::i8},   NamedValue{"u8", ValueType::u8},
                            NamedValue{"i16", ValueType::i16}, NamedValue{"u16", ValueType::u16},
                            NamedValue{"i32", ValueType::i32}, NamedValue{"u32", ValueType::u32},
                            NamedValue{"f32", ValueType::f32}, NamedValue{"f64", ValueType::f64}};

template <class T>
double nearest(double value) {
  if (std::isnan(value))
    return 0;
  return std::clamp(std::round(value), double{std::numeric_limits<T>::min()},
                    double{std::numeric_limits<T>::max()}) +
         0.0;  // an integer has no -0
}

}  // namespace

std::string_view name_of(ValueType type) {
  return name_in(kTypes, type);
}

std::optional<ValueType> value_type_of(std::string_view name) {
  return value_named(kTypes, name);
}

bool is_attribute_name(std::string_view name) {
  return !name.empty() && name.size() <= kMostNameBytes &&
         std::ranges::all_of(name, [](char c) { return c > ' ' && c <= '~'; });
}

double value_in(ValueType type, const float* channels) {
  if (!takes_two_channels(type))
    return channels[0];
  const std::uint64_t upper = std::bit_cast<std::uint32_t>(channels[0]);
  return std::bit_cast<double>(upper << 32 | std::bit_cast<std::uint32_t>(channels[1]));
}

void put_value(ValueType type, double value, float* channels) {
  if (!takes_two_channels(type)) {
    channels[0] = static_cast<float>(value);
    return;
  }
  const auto bits = std::bit_cast<std::uint64_t>(value);
  channels[0] = std::bit_cast<float>(static_cast<std::uint32_t>(bits >> 32));
  channels[1] = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
}

double of_type(ValueType type, double value) {
  switch (type) {
    case ValueType::i8:
      return nearest<std::int8_t>(value);
    case ValueType::u8:
      return nearest<std::uint8_t>(value);
    case ValueType::i16:
      return nearest<std::int16_t>(value);
    case ValueType::u16:
      return nearest<std::uint16_t>(value);
    case ValueType::i32:
      return nearest<std::int32_t>(value);
    case ValueType::u32:
      return nearest<std::uint32_t>(value);
    case ValueType::f32:
      return static_cast<float>(value);
    case ValueType::f64:
      break;
  }
  return value;
}

}  // namespace meshhier
