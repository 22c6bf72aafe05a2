#include "mesh_io/metadata_numbers.h"

#include "base/named_value.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

namespace meshhier::mesh_io {
namespace {

/// The names of a type, in property tables and in batch tables.
struct NumberRow {
  std::string_view name, batch_name;
  NumberType value;
  std::size_t bytes;
  double largest;  ///< of an integer
};
template <class Number>
constexpr double kLargest = static_cast<double>(std::numeric_limits<Number>::max());
constexpr std::array kNumberTypes{
    NumberRow{"INT8", "BYTE", NumberType::i8, 1, kLargest<std::int8_t>},
    NumberRow{"UINT8", "UNSIGNED_BYTE", NumberType::u8, 1, kLargest<std::uint8_t>},
    NumberRow{"INT16", "SHORT", NumberType::i16, 2, kLargest<std::int16_t>},
    NumberRow{"UINT16", "UNSIGNED_SHORT", NumberType::u16, 2, kLargest<std::uint16_t>},
    NumberRow{"INT32", "INT", NumberType::i32, 4, kLargest<std::int32_t>},
    NumberRow{"UINT32", "UNSIGNED_INT", NumberType::u32, 4, kLargest<std::uint32_t>},
    NumberRow{"INT64", "", NumberType::i64, 8, kLargest<std::int64_t>},
    NumberRow{"UINT64", "", NumberType::u64, 8, kLargest<std::uint64_t>},
    NumberRow{"FLOAT32", "FLOAT", NumberType::f32, 4, 1},
    NumberRow{"FLOAT64", "DOUBLE", NumberType::f64, 8, 1}};

template <class Number>
Number read_number(std::span<const std::byte> bytes) {
  if constexpr (std::is_integral_v<Number>)
    return static_cast<Number>(storage::load_little<std::make_unsigned_t<Number>>(bytes.data()));
  else
    return storage::load_little<Number>(bytes.data());
}

template <class Number>
ObjectValue load_value(std::span<const std::byte> bytes) {
  const Number number = read_number<Number>(bytes);
  if constexpr (sizeof(Number) == sizeof(std::uint64_t) &&
                std::numeric_limits<Number>::is_integer) {
    constexpr auto kMostWhole = Number{1} << 53;
    if (number > kMostWhole || (std::numeric_limits<Number>::is_signed && number < 0 - kMostWhole))
      return std::to_string(number);
  }
  const auto value = static_cast<double>(number);
  return std::isfinite(value) ? ObjectValue(value) : ObjectValue();
}

}  // namespace

std::optional<NumberType> number_type_of(std::string_view name) {
  const auto row = std::ranges::find_if(kNumberTypes, [&](const NumberRow& one) {
    return one.name == name || (!name.empty() && one.batch_name == name);
  });
  return row == kNumberTypes.end() ? std::nullopt : std::optional(row->value);
}

std::size_t bytes_of(NumberType type) {
  return row_with(kNumberTypes, type).bytes;
}

bool is_whole(NumberType type) {
  return type < NumberType::f32;
}

double fraction_of(NumberType type, double number) {
  return std::max(number / row_with(kNumberTypes, type).largest, -1.0);
}

ObjectValue number_in(NumberType type, std::span<const std::byte> bytes) {
  switch (type) {
    case NumberType::i8:
      return load_value<std::int8_t>(bytes);
    case NumberType::u8:
      return load_value<std::uint8_t>(bytes);
    case NumberType::i16:
      return load_value<std::int16_t>(bytes);
    case NumberType::u16:
      return load_value<std::uint16_t>(bytes);
    case NumberType::i32:
      return load_value<std::int32_t>(bytes);
    case NumberType::u32:
      return load_value<std::uint32_t>(bytes);
    case NumberType::i64:
      return load_value<std::int64_t>(bytes);
    case NumberType::u64:
      return load_value<std::uint64_t>(bytes);
    case NumberType::f32:
      return load_value<float>(bytes);
    case NumberType::f64:
      break;
  }
  return load_value<double>(bytes);
}

std::span<const std::byte> ByteParts::at(std::uint64_t offset, std::size_t bytes) {
  const bool is_held = offset >= first_ && offset + bytes <= first_ + window_.size();
  if (!is_held) {
    first_ = offset;
    window_.resize(static_cast<std::size_t>(
        std::min<std::uint64_t>(std::max(bytes, kWindow), range_.size - offset)));
    range_.read(first_, window_);
  }
  return std::span(window_).subspan(static_cast<std::size_t>(offset - first_), bytes);
}

}  // namespace meshhier::mesh_io
