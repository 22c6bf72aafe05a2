// Cuts the facets of a tile, with all that they show.
#pragma once

#include "base/half_space.h"
#include "base/vec.h"
#include "hierarchy/texture.h"
#include "render/facet.h"
#include "render/scene.h"

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::render {

/// A corner of a facet with its part of the skin.
struct CutCorner {
  Vec3d place;
  Vec3f normal, colour;
  Vec2f texcoord;
  Vec3f tangent;
};
using CutPolygon = std::vector<CutCorner>;

/// The corner at `part` of the way from one to another.
CutCorner mixed(const CutCorner& from, const CutCorner& to, double part);

/// Leaves of a convex polygon what lies in all half-spaces: nothing, if that is nothing. O(n).
void clip(CutPolygon& polygon, std::span<const HalfSpace> kept);

CutPolygon polygon_of(const SceneTile& tile, std::size_t facet);

/// Facets that take the place of a tile's.
class CutFacets {
 public:
  explicit CutFacets(SceneTile& tile) : tile_(tile) {}

  /// Adds a piece of a facet of the tile.
  void add(std::size_t facet, const CutCorner& a, const CutCorner& b, const CutCorner& c);
  /// Gives the tile what was added.
  void put() {
    tile_.facets = std::move(facets_);
    tile_.skins = std::move(skins_);
  }

 private:
  SceneTile& tile_;
  std::vector<Facet> facets_;
  std::vector<Skin> skins_;
};

/// From where one looks: an eye, or a direction to the viewer, who is far away.
struct Viewer {
  Vec3d place;
  bool is_far = false;

  Vec3d seen_from(Vec3d point) const { return is_far ? place : place - point; }
};

/// Leaves of a tile the facets whose corners turn counter-clockwise for the viewer, and those
/// without area, which stand for points. O(facets).
void drop_backs(SceneTile& tile, const Viewer& viewer);

/// Leaves of a tile what lies in all half-spaces. Facets without area, which stand for points, stay
/// or go. O(facets).
void clip(SceneTile& tile, std::span<const HalfSpace> kept);

}  // namespace meshhier::render
