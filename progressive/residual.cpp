#include "progressive/residual.h"

#include "hierarchy/detail.h"

#include <bit>
#include <cassert>

namespace meshhier::progressive {
namespace {

constexpr std::uint32_t kSign = 0x80000000U;

/// Returns a number that ascends with the float, by one from each to the next.
std::uint32_t ordered(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

float unordered(std::uint32_t number) {
  return std::bit_cast<float>((number & kSign) != 0 ? number & ~kSign : ~number);
}

std::uint32_t to_number(float value, int bytes) {
  return bytes == 4 ? ordered(value) : static_cast<std::uint32_t>(value);
}

float to_value(std::uint32_t number, int bytes) {
  return bytes == 4 ? unordered(number) : static_cast<float>(number);
}

constexpr std::uint32_t mask_of(int bytes) {
  return 0xFFFFFFFFU >> (32 - 8 * bytes);
}

/// Returns 0, 1, 2, 3, ... for 0, -1, 1, -2, ..., of so many bytes.
std::uint32_t fold(std::uint32_t difference, int bytes) {
  const std::uint32_t mask = mask_of(bytes);
  const bool negative = (difference >> (8 * bytes - 1) & 1) != 0;
  return ((difference << 1) ^ (negative ? mask : 0)) & mask;
}

std::uint32_t unfold(std::uint32_t residual, int bytes) {
  const std::uint32_t mask = mask_of(bytes);
  const std::uint32_t half = (residual & mask) >> 1;
  return (residual & 1) != 0 ? ~half & mask : half;
}

}  // namespace

void find_residuals(const AttributeLayout& layout, std::span<const float> values,
                    std::span<const float> predicted, std::span<std::uint32_t> residuals) {
  assert(std::ssize(values) == vertex_values(layout));
  for (int i = 0; i < std::ssize(values); ++i) {
    const int bytes = value_bytes(layout, i);
    residuals[i] = fold(to_number(values[i], bytes) - to_number(predicted[i], bytes), bytes);
  }
}

void add_residuals(const AttributeLayout& layout, std::span<const std::uint32_t> residuals,
                   std::span<const float> predicted, std::span<float> values) {
  assert(std::ssize(values) == vertex_values(layout));
  for (int i = 0; i < std::ssize(values); ++i) {
    const int bytes = value_bytes(layout, i);
    const std::uint32_t number = to_number(predicted[i], bytes) + unfold(residuals[i], bytes);
    values[i] = to_value(number & mask_of(bytes), bytes);
  }
}

}  // namespace meshhier::progressive
