#include "shading/tile_shading.h"

#include "base/error.h"
#include "hierarchy/vertex_numbers.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <tuple>

namespace meshhier::shading {
namespace {

/// A further normal of a vertex.
struct Split {
  std::uint32_t vertex = 0;
  NormalCode normal{};
  bool is_used = false;
};

/// Along the triangle's normal, with the same bits however the triangle is turned.
Vec3d direction_of(const std::vector<Vec3f>& positions, const TileTriangle& triangle) {
  const auto key = [&](std::size_t k) {
    const Vec3f& p = positions[raw(triangle[k])];
    return std::tuple(p.x, p.y, p.z);
  };
  std::size_t first = key(1) < key(0) ? 1 : 0;
  first = key(2) < key(first) ? 2 : first;
  const TileTriangle from_first = turned(triangle, first);
  const auto point = [&](std::size_t k) { return to_double(positions[raw(from_first[k])]); };
  return cross(point(1) - point(0), point(2) - point(0));
}

double alignment(const NormalCode& normal, const Vec3d& direction) {
  return dot(Vec3d{double(normal[0]), double(normal[1]), double(normal[2])}, direction);
}

class Assembler {
 public:
  Assembler(const TileMesh& mesh, const OwnShading& own) : mesh_(mesh) {
    const std::size_t own_count = mesh.own_count + mesh.copies.first_of(mesh.own_count);
    normals_.resize(place_count() + mesh.copies.size(), kNoDirection);
    const auto number = [&](std::uint32_t vertex) {
      return vertex < mesh_.own_count ? vertex : vertex - mesh_.own_count + place_count();
    };
    for (std::uint32_t v = 0; v < own_count; ++v)
      normals_[number(v)] = own.normals[v];
    for (std::size_t i = 0; i < own.split_of.size(); ++i)
      splits_.push_back({number(own.split_of[i]), own.normals[own_count + i]});
  }

  /// The ghosts [begin, end) belong to this neighbour.
  void add_ghosts(std::size_t begin, std::size_t end, const BoundaryShading& of) {
    const std::size_t own_copies = mesh_.copies.size() - mesh_.ghost_wedges.size();
    const auto first_copy = [&](std::uint32_t place) {
      return static_cast<std::size_t>(
          std::lower_bound(of.copy_places.begin(), of.copy_places.end(), place) -
          of.copy_places.begin());
    };
    for (std::size_t g = begin; g < end; ++g) {
      const std::uint32_t there = mesh_.ghosts[g].index;
      const auto place = static_cast<std::uint32_t>(mesh_.own_count + g);
      if (there >= of.boundary_count)
        throw Error(ErrorCode::internal, "a ghost lies outside its tile's boundary");
      take(place, there, of);
      for (std::size_t c = mesh_.copies.first_of(place); c < mesh_.copies.first_of(place + 1); ++c)
        take(place_count() + c,
             of.boundary_count + first_copy(there) + mesh_.ghost_wedges[c - own_copies] - 1, of);
    }
  }

  Shading operator()() && {
    Shading shading;
    shading.normals = std::move(normals_);
    if (splits_.empty())
      return shading;
    std::stable_sort(splits_.begin(), splits_.end(),
                     [](const Split& a, const Split& b) { return a.vertex < b.vertex; });
    const VertexNumbers numbers(place_count(), mesh_.copies.places);
    shading.interior = numbers.numbered(mesh_.interior, mesh_.interior_wedges);
    shading.border = numbers.numbered(mesh_.border, mesh_.border_wedges);
    const std::vector<std::uint32_t> firsts = first_splits(shading.normals.size());
    choose(mesh_.interior, shading.interior, shading.normals, firsts);
    choose(mesh_.border, shading.border, shading.normals, firsts);
    drop_unused(shading);
    return shading;
  }

 private:
  std::uint32_t place_count() const { return static_cast<std::uint32_t>(mesh_.vertices.size()); }

  /// The normals of a neighbour's vertex become those of one here.
  void take(std::size_t vertex, std::size_t there, const BoundaryShading& of) {
    const std::vector<std::uint32_t>& split_of = of.shading.split_of;
    const std::size_t vertex_count = of.boundary_count + of.copy_places.size();
    normals_[vertex] = of.shading.normals.at(there);
    const auto [begin, end] = std::equal_range(split_of.begin(), split_of.end(), there);
    for (auto split = begin; split != end; ++split)
      splits_.push_back(
          {static_cast<std::uint32_t>(vertex),
           of.shading.normals[vertex_count + static_cast<std::size_t>(split - split_of.begin())]});
  }

  /// Returns each vertex's first split, once these are sorted; their count at the end.
  std::vector<std::uint32_t> first_splits(std::size_t vertex_count) const {
    std::vector<std::uint32_t> firsts(vertex_count + 1);
    for (const Split& split : splits_)
      ++firsts[split.vertex + 1];
    std::partial_sum(firsts.begin(), firsts.end(), firsts.begin());
    return firsts;
  }

  /// Gives corners of vertices with splits the number of one, counted from all vertices on.
  /// `normals`: of the vertices.
  void choose(const std::vector<TileTriangle>& triangles, std::vector<TileTriangle>& corners,
              std::span<const NormalCode> normals, std::span<const std::uint32_t> first_splits) {
    const auto vertex_count = static_cast<std::uint32_t>(normals.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (TileVertex& corner : corners[t]) {
        const std::uint32_t vertex = raw(corner);
        if (first_splits[vertex] == first_splits[vertex + 1])
          continue;
        const Vec3d direction = direction_of(mesh_.vertices.positions, triangles[t]);
        double best = alignment(normals[vertex], direction);
        for (std::uint32_t i = first_splits[vertex]; i < first_splits[vertex + 1]; ++i) {
          if (const double other = alignment(splits_[i].normal, direction); other > best) {
            best = other;
            corner = TileVertex{vertex_count + i};
          }
        }
        if (raw(corner) >= vertex_count)
          splits_[raw(corner) - vertex_count].is_used = true;
      }
    }
  }

  void drop_unused(Shading& shading) const {
    const auto vertex_count = static_cast<std::uint32_t>(shading.normals.size());
    std::vector<std::uint32_t> place(splits_.size());
    for (std::size_t i = 0; i < splits_.size(); ++i) {
      place[i] = static_cast<std::uint32_t>(shading.split_of.size());
      if (!splits_[i].is_used)
        continue;
      shading.split_of.push_back(splits_[i].vertex);
      shading.normals.push_back(splits_[i].normal);
    }
    for (auto* triangles : {&shading.interior, &shading.border}) {
      for (TileTriangle& t : *triangles) {
        for (TileVertex& corner : t)
          corner = raw(corner) < vertex_count
                       ? corner
                       : TileVertex{vertex_count + place[raw(corner) - vertex_count]};
      }
    }
    if (shading.split_of.empty()) {
      shading.interior.clear();
      shading.border.clear();
    }
  }

  const TileMesh& mesh_;
  std::vector<NormalCode> normals_;
  std::vector<Split> splits_;
};

}  // namespace

BoundaryShading boundary_of(const OwnShading& shading, const TileMesh& mesh) {
  const auto own_copies = static_cast<std::uint32_t>(mesh.copies.first_of(mesh.own_count));
  const auto copies = static_cast<std::uint32_t>(mesh.copies.first_of(mesh.boundary_count));
  BoundaryShading boundary;
  boundary.boundary_count = mesh.boundary_count;
  boundary.copy_places.assign(mesh.copies.places.begin(), mesh.copies.places.begin() + copies);
  std::vector<NormalCode>& normals = boundary.shading.normals;
  normals.assign(shading.normals.begin(), shading.normals.begin() + mesh.boundary_count);
  normals.insert(normals.end(), shading.normals.begin() + mesh.own_count,
                 shading.normals.begin() + mesh.own_count + copies);
  for (std::size_t i = 0; i < shading.split_of.size(); ++i) {
    const std::uint32_t vertex = shading.split_of[i];
    const bool is_place = vertex < mesh.own_count;
    if (is_place ? vertex >= mesh.boundary_count : vertex - mesh.own_count >= copies)
      continue;
    boundary.shading.split_of.push_back(is_place ? vertex
                                                 : vertex - mesh.own_count + mesh.boundary_count);
    normals.push_back(shading.normals[mesh.own_count + own_copies + i]);
  }
  return boundary;
}

OwnShading renumbered(const OwnShading& shading, std::span<const std::uint32_t> copy_places,
                      std::span<const std::uint32_t> place, std::uint32_t own_count) {
  const std::size_t copy_count = shading.normals.size() - shading.split_of.size() - own_count;
  std::vector<std::uint32_t> old_copies(copy_count);
  std::iota(old_copies.begin(), old_copies.end(), 0U);
  std::stable_sort(old_copies.begin(), old_copies.end(), [&](std::uint32_t a, std::uint32_t b) {
    return place[copy_places[a]] < place[copy_places[b]];
  });
  std::vector<std::uint32_t> number(own_count + copy_count);
  std::copy_n(place.begin(), own_count, number.begin());
  for (std::uint32_t i = 0; i < old_copies.size(); ++i)
    number[own_count + old_copies[i]] = own_count + i;

  OwnShading result;
  result.normals.resize(number.size());
  for (std::size_t v = 0; v < number.size(); ++v)
    result.normals[number[v]] = shading.normals[v];
  std::vector<std::uint32_t> splits(shading.split_of.size());
  std::iota(splits.begin(), splits.end(), 0U);
  std::stable_sort(splits.begin(), splits.end(), [&](std::uint32_t a, std::uint32_t b) {
    return number[shading.split_of[a]] < number[shading.split_of[b]];
  });
  for (const std::uint32_t split : splits) {
    result.split_of.push_back(number[shading.split_of[split]]);
    result.normals.push_back(shading.normals[number.size() + split]);
  }
  return result;
}

Shading shade_tile(const TileMesh& mesh, const OwnShading& own,
                   const std::function<BoundaryShading(std::uint32_t tile)>& neighbour) {
  Assembler assembler(mesh, own);
  for (std::size_t begin = 0, end = 0; begin < mesh.ghosts.size(); begin = end) {
    while (end < mesh.ghosts.size() && mesh.ghosts[end].tile == mesh.ghosts[begin].tile)
      ++end;
    assembler.add_ghosts(begin, end, neighbour(mesh.ghosts[begin].tile));
  }
  return std::move(assembler)();
}

}  // namespace meshhier::shading
