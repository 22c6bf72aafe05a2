// Numbers of a tile's vertices as files have them: the places' first vertices, then all copies.
#pragma once

#include "hierarchy/tile_mesh.h"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier {

/// A vertex by its place.
struct Wedge {
  std::uint32_t place = 0;
  std::uint32_t wedge = 0;  ///< at that place, as CornerWedges
  friend constexpr auto operator<=>(const Wedge&, const Wedge&) = default;
};

/// The first vertex of place p has the number p, copy i the number place_count + i.
class VertexNumbers {
 public:
  /// `copies`: ascending, without repeats, wedges >= 1.
  VertexNumbers(std::uint32_t place_count, std::vector<Wedge> copies)
      : place_count_(place_count), copies_(std::move(copies)) {}
  /// `copy_places`: as Copies::places. All wedges of a place are there.
  VertexNumbers(std::uint32_t place_count, std::span<const std::uint32_t> copy_places);

  /// Requires a place's first vertex or one of the copies. O(log copies).
  std::uint32_t number_of(const Wedge& wedge) const;
  /// The inverse. O(1).
  Wedge operator[](std::uint32_t number) const {
    return number < place_count_ ? Wedge{number, 0} : copies_[number - place_count_];
  }

  /// The triangles with vertices' numbers instead of places. `wedges`: one entry each; all 0 if
  /// there are none.
  std::vector<TileTriangle> numbered(std::span<const TileTriangle> triangles,
                                     std::span<const CornerWedges> wedges) const;
  /// The inverse: turns vertices' numbers into places, and returns the wedges.
  std::vector<CornerWedges> split(std::span<TileTriangle> triangles) const;

 private:
  std::uint32_t place_count_;
  std::vector<Wedge> copies_;
};

/// Each copy by its place. `copy_places`: as Copies::places.
std::vector<Wedge> wedges_of(std::span<const std::uint32_t> copy_places);

}  // namespace meshhier
