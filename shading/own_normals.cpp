#include "shading/own_normals.h"

#include "shading/crease.h"
#include "shading/fan_groups.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::shading {
namespace {

/// Along the triangle's normal, twice its area long.
Vec3d area_of(std::span<const Vec3f> positions, const TileTriangle& triangle) {
  const Vec3d a = to_double(positions[raw(triangle[0])]);
  const Vec3d b = to_double(positions[raw(triangle[1])]);
  const Vec3d c = to_double(positions[raw(triangle[2])]);
  return cross(b - a, c - a);
}

/// The triangles of a tile, interior first, with their areas and the wedges of their corners.
class Corners {
 public:
  explicit Corners(const TileMesh& mesh) : mesh_(mesh), areas_(count()) {}

  std::size_t count() const { return mesh_.interior.size() + mesh_.border.size(); }
  const TileTriangle& operator[](std::size_t t) const {
    return is_interior(t) ? mesh_.interior[t] : mesh_.border[t - mesh_.interior.size()];
  }
  std::uint32_t wedge(std::size_t t, std::size_t corner) const {
    const auto& wedges = is_interior(t) ? mesh_.interior_wedges : mesh_.border_wedges;
    return wedges.empty() ? 0 : wedges[is_interior(t) ? t : t - mesh_.interior.size()][corner];
  }
  /// Along the triangle's normal, twice its area long; once it is set.
  const Vec3d& area(std::size_t t) const { return areas_[t]; }
  Vec3d& area(std::size_t t) { return areas_[t]; }

  /// Calls visit(t, triangle) for each.
  template <class Visit>
  void for_each(const Visit& visit) const {
    std::uint32_t t = 0;
    for (const auto* triangles : {&mesh_.interior, &mesh_.border}) {
      for (const TileTriangle& triangle : *triangles)
        visit(t++, triangle);
    }
  }

 private:
  bool is_interior(std::size_t t) const { return t < mesh_.interior.size(); }
  const TileMesh& mesh_;
  std::vector<Vec3d> areas_;
};

/// All that is asked of a place for each of its triangles, in one cache line.
struct alignas(32) Place {
  Vec3d sum;         ///< of the areas around it; around a ghost, of as much as the tile has
  double limit = 0;  ///< part of a triangle's size along `sum`: with less it may be a crease apart
};

/// Sets the areas of all triangles, and sums them around each place.
std::vector<Place> sum_areas(const TileMesh& mesh, Corners& corners) {
  std::vector<Place> places(mesh.vertices.size());
  corners.for_each([&](std::uint32_t t, const TileTriangle& triangle) {
    const Vec3d area = area_of(mesh.vertices.positions, triangle);
    corners.area(t) = area;
    for (const TileVertex v : triangle)
      places[raw(v)].sum = places[raw(v)].sum + area;
  });
  return places;
}

/// Marks own places with a triangle so far from the mean that two may be a crease apart. Where two
/// sides cancel there is no mean: any triangle is far from it.
std::vector<char> find_rough_places(const TileMesh& mesh, const Corners& corners,
                                    std::vector<Place>& places) {
  const double cosine = crease_cosine(0.5);
  for (std::size_t v = 0; v < mesh.own_count; ++v)
    places[v].limit = places[v].sum == Vec3d{} ? 1 : cosine * length(places[v].sum);
  for (std::size_t v = mesh.own_count; v < places.size(); ++v)
    places[v].limit = -std::numeric_limits<double>::infinity();
  std::vector<char> is_rough(places.size());
  corners.for_each([&](std::uint32_t t, const TileTriangle& triangle) {
    const Vec3d area = corners.area(t);
    const double size = length(area);
    for (const TileVertex v : triangle) {
      const Place& place = places[raw(v)];
      is_rough[raw(v)] |= static_cast<char>(dot(area, place.sum) < place.limit * size);
    }
  });
  return is_rough;
}

/// A triangle's corner at a rough place.
struct RoughCorner {
  std::uint32_t place = 0;
  std::uint32_t triangle = 0;
  std::uint32_t corner = 0;
};

/// By their places; those of a place in the order of the triangles.
std::vector<RoughCorner> rough_corners(const TileMesh& mesh, const Corners& corners,
                                       const std::vector<char>& is_rough) {
  std::vector<RoughCorner> found;
  std::vector<std::uint32_t> ends(mesh.own_count + 1);
  corners.for_each([&](std::uint32_t t, const TileTriangle& triangle) {
    if ((is_rough[raw(triangle[0])] | is_rough[raw(triangle[1])] | is_rough[raw(triangle[2])]) == 0)
      return;
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (is_rough[raw(triangle[k])] == 0)
        continue;
      found.push_back({raw(triangle[k]), t, k});
      ++ends[raw(triangle[k]) + 1];
    }
  });
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<RoughCorner> sorted(found.size());
  for (const RoughCorner& corner : found)
    sorted[ends[corner.place]++] = corner;
  return sorted;
}

/// Makes the normals of one place after another.
class Shader {
 public:
  explicit Shader(const TileMesh& mesh)
      : mesh_(mesh),
        corners_(mesh),
        copy_count_(mesh.copies.first_of(mesh.own_count)),
        grouper_(mesh.vertices.size()) {}

  OwnShading operator()() && {
    std::vector<Place> places = sum_areas(mesh_, corners_);
    const std::vector<char> is_rough = find_rough_places(mesh_, corners_, places);
    shading_.normals.resize(mesh_.own_count + copy_count_);
    for (std::size_t v = 0; v < mesh_.own_count; ++v)
      shading_.normals[v] = normal_code(places[v].sum);
    for (std::size_t i = 0; i < copy_count_; ++i)
      shading_.normals[mesh_.own_count + i] = shading_.normals[mesh_.copies.places[i]];
    const std::vector<RoughCorner> rough = rough_corners(mesh_, corners_, is_rough);
    for (std::size_t begin = 0, end = 0; begin < rough.size(); begin = end) {
      while (end < rough.size() && rough[end].place == rough[begin].place)
        ++end;
      shade_place(std::span(rough).subspan(begin, end - begin));
    }
    add_splits();
    return std::move(shading_);
  }

 private:
  struct Split {
    std::uint32_t vertex = 0;
    NormalCode normal{};
  };
  /// A normal that a vertex has, by the number of its group.
  struct Shown {
    std::uint32_t vertex = 0;
    std::uint32_t group = 0;
    friend constexpr auto operator<=>(const Shown&, const Shown&) = default;
  };

  std::uint32_t vertex_of(const RoughCorner& corner) const {
    const std::uint32_t wedge = corners_.wedge(corner.triangle, corner.corner);
    const auto first = static_cast<std::uint32_t>(mesh_.copies.first_of(corner.place));
    return wedge == 0 ? corner.place : mesh_.own_count + first + wedge - 1;
  }

  void shade_place(std::span<const RoughCorner> rough) {
    fan_.resize(rough.size());
    for (std::size_t i = 0; i < rough.size(); ++i) {
      const TileTriangle& t = corners_[rough[i].triangle];
      fan_[i] = {raw(t[(rough[i].corner + 1) % 3]), raw(t[(rough[i].corner + 2) % 3]),
                 corners_.area(rough[i].triangle)};
    }
    const FanGroups& groups = grouper_.group(fan_);
    if (groups.is_one_fan)
      return;  // the sum of all areas is its normal
    shown_.resize(rough.size());
    for (std::size_t i = 0; i < rough.size(); ++i)
      shown_[i] = {vertex_of(rough[i]), groups.group_of[i]};
    std::sort(shown_.begin(), shown_.end());
    shown_.erase(std::unique(shown_.begin(), shown_.end()), shown_.end());
    set_all(rough[0].place, normal_code(groups.normals[0]));
    for (std::size_t i = 0; i < shown_.size(); ++i) {
      const NormalCode normal = normal_code(groups.normals[shown_[i].group]);
      if (i == 0 || shown_[i].vertex != shown_[i - 1].vertex)
        shading_.normals[shown_[i].vertex] = normal;
      else
        splits_.push_back({shown_[i].vertex, normal});
    }
  }

  /// Gives all vertices of a place one normal. Those that no triangle uses keep it.
  void set_all(std::uint32_t place, const NormalCode& normal) {
    shading_.normals[place] = normal;
    for (std::size_t i = mesh_.copies.first_of(place);
         i < copy_count_ && mesh_.copies.places[i] == place; ++i)
      shading_.normals[mesh_.own_count + i] = normal;
  }

  void add_splits() {
    std::stable_sort(splits_.begin(), splits_.end(),
                     [](const Split& a, const Split& b) { return a.vertex < b.vertex; });
    for (const Split& split : splits_) {
      shading_.split_of.push_back(split.vertex);
      shading_.normals.push_back(split.normal);
    }
  }

  const TileMesh& mesh_;
  Corners corners_;
  std::size_t copy_count_;  ///< of own places
  OwnShading shading_;
  std::vector<Split> splits_;
  FanGrouper grouper_;
  // For the place at hand:
  std::vector<FanCorner> fan_;
  std::vector<Shown> shown_;
};

}  // namespace

OwnShading shade(const TileMesh& mesh) {
  return Shader(mesh)();
}

}  // namespace meshhier::shading
