// Triangles by the ids of their corners.
//
// A triangle is its three corners in order: turning them is the same triangle, swapping two is its
// mirror image. The one form to compare and sort by has the smallest corner first, canonical().
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace meshhier {

/// A corner's name: a strong id, or a plain number where no id is made for it.
template <class Id>
concept CornerId = std::is_enum_v<Id> || std::unsigned_integral<Id>;

/// Three corners; in memory, spools and files three ids without padding. Compares corner by corner.
template <class Id>
using Triangle = std::array<Id, 3>;

static_assert(sizeof(Triangle<std::uint32_t>) == 12 && sizeof(Triangle<std::uint64_t>) == 24);

// Which corner is the smallest, and which triangle degenerate, no processor can predict: these do
// without branches.

/// The place of the smallest corner, 0 to 2. It is 0 if the smallest is there twice.
template <CornerId Id>
constexpr std::size_t smallest_corner(const Triangle<Id>& t) {
  const bool second = bool(int{t[1] < t[0]} & int{t[1] < t[2]});
  const bool third = bool(int{t[2] < t[0]} & int{t[2] < t[1]});
  return std::size_t{second} + 2 * std::size_t{third};
}

/// The same triangle, beginning with the corner at place `first`, 0 to 2.
template <CornerId Id>
constexpr Triangle<Id> turned(const Triangle<Id>& t, std::size_t first) {
  constexpr std::array<std::size_t, 5> kTurn{0, 1, 2, 0, 1};
  return {t[first], t[kTurn[first + 1]], t[kTurn[first + 2]]};
}

/// The same triangle with its smallest corner first. Equal for all turns of a triangle that is not
/// degenerate.
template <CornerId Id>
constexpr Triangle<Id> canonical(const Triangle<Id>& t) {
  return turned(t, smallest_corner(t));
}

/// Whether two corners are one.
template <CornerId Id>
constexpr bool is_degenerate(const Triangle<Id>& t) {
  return (int{t[0] == t[1]} | int{t[1] == t[2]} | int{t[2] == t[0]}) != 0;
}

}  // namespace meshhier
