// The wedges of a tile as one list, and its triangles by them.
//
// A wedge's number is its vertex number in the tile's file: that of its place if it is the place's
// first, and the copies come after all places.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"
#include "hierarchy/triangle.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// Its corners are wedges, at three places.
using WedgeTriangle = Triangle<std::uint32_t>;

class TileWedges {
 public:
  /// `mesh` outlives this. O(n + t).
  explicit TileWedges(const TileMesh& mesh);

  std::uint32_t place_count() const { return static_cast<std::uint32_t>(mesh_.vertices.size()); }
  std::uint32_t own_place_count() const { return mesh_.own_count; }
  std::uint32_t count() const { return place_count() + first_copies_.back(); }

  /// The wedge that a place calls its `number`th.
  std::uint32_t at(std::uint32_t place, std::uint32_t number) const {
    return number == 0 ? place : place_count() + first_copies_[place] + number - 1;
  }
  std::uint32_t count_at(std::uint32_t place) const {
    return 1 + first_copies_[place + 1] - first_copies_[place];
  }
  std::uint32_t place_of(std::uint32_t wedge) const {
    return wedge < place_count() ? wedge : mesh_.copies.places[wedge - place_count()];
  }
  bool is_own(std::uint32_t wedge) const { return place_of(wedge) < mesh_.own_count; }

  Vec3f position_of(std::uint32_t wedge) const { return mesh_.vertices.positions[place_of(wedge)]; }
  std::span<const float> attributes_of(std::uint32_t wedge) const {
    return wedge < place_count() ? mesh_.vertices.attributes_of(wedge)
                                 : mesh_.copies.vertices.attributes_of(wedge - place_count());
  }

  /// Interior ones first. Those with two corners at one place are left out: they show nothing, and
  /// would tie together what lies on the two sides of a seam.
  std::span<const WedgeTriangle> triangles() const { return triangles_; }

 private:
  void add(std::span<const TileTriangle> triangles, std::span<const CornerWedges> wedges);

  const TileMesh& mesh_;
  std::vector<std::uint32_t> first_copies_;  ///< of each place, and how many there are at all
  std::vector<WedgeTriangle> triangles_;
};

}  // namespace meshhier::cluster_simplify
