#include "cluster_simplify/seams.h"

#include "hierarchy/error.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace meshhier::cluster_simplify {
namespace {

constexpr std::uint32_t kUnset = std::numeric_limits<std::uint32_t>::max();

/// Sorts and removes repeats; returns for each old entry its new place.
std::vector<std::uint32_t> make_unique(std::vector<GhostRef>& refs) {
  std::vector<GhostRef> sorted = refs;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  std::vector<std::uint32_t> place(refs.size());
  for (std::size_t i = 0; i < refs.size(); ++i) {
    place[i] = static_cast<std::uint32_t>(std::lower_bound(sorted.begin(), sorted.end(), refs[i]) -
                                          sorted.begin());
  }
  refs = std::move(sorted);
  return place;
}

template <class Map>
TileTriangle mapped(const TileTriangle& t, const Map& map) {
  return {map(t[0]), map(t[1]), map(t[2])};
}

/// The images of triangles that keep an area. Half of them may go, which ones no processor can
/// predict: no branch.
template <class Map>
std::vector<TileTriangle> images(const std::vector<TileTriangle>& triangles, const Map& map) {
  std::vector<TileTriangle> kept(triangles.size());
  std::size_t count = 0;
  for (const TileTriangle& t : triangles) {
    const TileTriangle image = mapped(t, map);
    kept[count] = image;
    count += std::size_t{!is_degenerate(image)};
  }
  kept.resize(count);
  return kept;
}

/// Removes the references no triangle uses and renumbers the corners from `own_count` on.
template <class Ref>
void drop_unused(std::vector<TileTriangle>& border, std::vector<Ref>& refs,
                 std::uint32_t own_count) {
  std::vector<std::uint32_t> place(refs.size(), kUnset);
  for (const TileTriangle& t : border) {
    for (const TileVertex corner : t) {
      if (raw(corner) >= own_count)
        place[raw(corner) - own_count] = 0;
    }
  }
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < refs.size(); ++i) {
    if (place[i] == kUnset)
      continue;
    place[i] = kept;
    refs[kept++] = refs[i];
  }
  refs.resize(kept);
  for (TileTriangle& t : border) {
    t = mapped(t, [&](TileVertex v) {
      return raw(v) < own_count ? v
                                : static_cast<TileVertex>(own_count + place[raw(v) - own_count]);
    });
  }
}

}  // namespace

FallbackCounts& FallbackCounts::operator+=(const FallbackCounts& other) {
  torn += other.torn;
  turned += other.turned;
  forced += other.forced;
  joined += other.joined;
  return *this;
}

template <class Corner>
BuildTile resolve(WorkTile<Corner> tile, std::span<const GhostRef> mapped_refs, bool unique) {
  assert(mapped_refs.size() == tile.foreign.size());
  const auto own_count = static_cast<std::uint32_t>(tile.vertices.size());
  std::vector<GhostRef> ghosts(mapped_refs.begin(), mapped_refs.end());
  const std::vector<std::uint32_t> place = make_unique(ghosts);
  for (TileTriangle& t : tile.border) {
    t = mapped(t, [&](TileVertex v) {
      return raw(v) < own_count ? v
                                : static_cast<TileVertex>(own_count + place[raw(v) - own_count]);
    });
  }
  normalize_triangles(tile.border, unique);
  drop_unused(tile.border, ghosts, own_count);  // order-preserving: the triangles stay sorted

  BuildTile result;
  result.mesh = {.vertices = std::move(tile.vertices),
                 .own_count = own_count,
                 .boundary_count = tile.boundary_count,
                 .ghosts = std::move(ghosts),
                 .interior = std::move(tile.interior),
                 .border = std::move(tile.border)};
  result.history = std::move(tile.history);
  return result;
}

template BuildTile resolve(LeafTile tile, std::span<const GhostRef> mapped, bool unique);
template BuildTile resolve(SimplifiedTile tile, std::span<const GhostRef> mapped, bool unique);

void fill_ghosts(BuildTile& tile, std::uint32_t neighbour, const Boundary& boundary) {
  const auto& ghosts = tile.mesh.ghosts;
  auto ghost = std::lower_bound(ghosts.begin(), ghosts.end(), GhostRef{neighbour, 0});
  std::vector<std::uint32_t> named;
  for (; ghost != ghosts.end() && ghost->tile == neighbour; ++ghost) {
    if (ghost->index >= boundary.vertices.size())
      throw Error(ErrorCode::internal, "a ghost lies outside its tile's boundary");
    named.push_back(ghost->index);
  }
  tile.mesh.vertices.append(boundary.vertices, named);
}

BuildTile join(const BuildTile& first, std::uint32_t first_index, const BuildTile& second,
               std::uint32_t second_index) {
  const TileMesh& a = first.mesh;
  const TileMesh& b = second.mesh;
  const std::uint32_t own_count = a.own_count + b.own_count;
  BuildTile joined;
  TileMesh& mesh = joined.mesh;
  mesh.own_count = own_count;
  mesh.vertices.channels = a.vertices.channels;
  mesh.vertices.reserve(own_count + a.ghosts.size() + b.ghosts.size());
  mesh.vertices.append(a.vertices, 0, a.own_count);
  mesh.vertices.append(b.vertices, 0, b.own_count);
  joined.history.weights = first.history.weights;
  joined.history.weights.insert(joined.history.weights.end(), second.history.weights.begin(),
                                second.history.weights.end());

  // Outside ghosts of both, merged.
  struct Outside {
    GhostRef ref;
    const BuildTile* tile;
    std::uint32_t vertex;
  };
  std::vector<Outside> outside;
  const auto collect = [&](const BuildTile& tile, std::uint32_t sibling) {
    for (std::uint32_t i = 0; i < tile.mesh.ghosts.size(); ++i) {
      if (tile.mesh.ghosts[i].tile != sibling)
        outside.push_back({tile.mesh.ghosts[i], &tile, tile.mesh.own_count + i});
    }
  };
  collect(first, second_index);
  collect(second, first_index);
  std::stable_sort(outside.begin(), outside.end(),
                   [](const Outside& x, const Outside& y) { return x.ref < y.ref; });
  outside.erase(std::unique(outside.begin(), outside.end(),
                            [](const Outside& x, const Outside& y) { return x.ref == y.ref; }),
                outside.end());
  for (const Outside& ghost : outside) {
    mesh.ghosts.push_back(ghost.ref);
    mesh.vertices.append(ghost.tile->mesh.vertices, ghost.vertex, ghost.vertex + 1);
  }

  const auto place_of = [&](const TileMesh& tile, std::uint32_t offset, std::uint32_t sibling,
                            std::uint32_t sibling_offset) {
    std::vector<TileVertex> place(tile.vertices.size());
    for (std::uint32_t i = 0; i < tile.own_count; ++i)
      place[i] = static_cast<TileVertex>(offset + i);
    for (std::uint32_t i = 0; i < tile.ghosts.size(); ++i) {
      const GhostRef& ref = tile.ghosts[i];
      const auto found = std::lower_bound(mesh.ghosts.begin(), mesh.ghosts.end(), ref);
      place[tile.own_count + i] = static_cast<TileVertex>(
          ref.tile == sibling
              ? sibling_offset + ref.index
              : own_count + static_cast<std::uint32_t>(found - mesh.ghosts.begin()));
    }
    return place;
  };
  const std::vector<TileVertex> place_a = place_of(a, 0, second_index, a.own_count);
  const std::vector<TileVertex> place_b = place_of(b, a.own_count, first_index, 0);

  mesh.interior.reserve(a.interior.size() + b.interior.size() + a.border.size());
  mesh.interior = a.interior;
  for (const TileTriangle& t : b.interior)  // own corners move by as much as the first tile has
    mesh.interior.push_back(
        mapped(t, [&](TileVertex v) { return static_cast<TileVertex>(raw(v) + a.own_count); }));
  const auto add_border = [&](const TileTriangle& t) {
    const bool inside =
        std::all_of(t.begin(), t.end(), [&](TileVertex v) { return raw(v) < own_count; });
    (inside ? mesh.interior : mesh.border).push_back(t);
  };
  for (const TileTriangle& t : a.border)
    add_border(mapped(t, [&](TileVertex v) { return place_a[raw(v)]; }));
  for (const TileTriangle& t : b.border) {
    const TileTriangle placed = mapped(t, [&](TileVertex v) { return place_b[raw(v)]; });
    const bool known = std::any_of(placed.begin(), placed.end(),
                                   [&](TileVertex v) { return raw(v) < a.own_count; });
    if (!known)
      add_border(placed);  // a triangle that touches the first tile came with it
  }
  return joined;  // every outside ghost still has its border triangle
}

namespace {

/// New numbers for representatives: those of border triangles first, order kept otherwise.
std::vector<std::uint32_t> boundary_first(const std::vector<TileTriangle>& border,
                                          std::uint32_t count, std::uint32_t& boundary_count) {
  std::vector<std::uint32_t> place(count, kUnset);
  for (const TileTriangle& t : border) {
    for (const TileVertex v : t) {
      if (raw(v) < count)
        place[raw(v)] = 0;
    }
  }
  boundary_count = static_cast<std::uint32_t>(std::count(place.begin(), place.end(), 0U));
  std::uint32_t boundary = 0;
  std::uint32_t inner = boundary_count;
  for (std::uint32_t& entry : place)
    entry = entry == 0 ? boundary++ : inner++;
  return place;
}

/// The ghosts of a joined tile as foreign corners of the tile that it becomes.
std::vector<FinerGhost> one_level_up(const std::vector<GhostRef>& ghosts) {
  std::vector<FinerGhost> foreign;
  foreign.reserve(ghosts.size());
  for (const GhostRef& ghost : ghosts)
    foreign.push_back({ghost});
  return foreign;
}

}  // namespace

ContractedTile apply(const BuildTile& joined, Contraction contraction) {
  const TileMesh& mesh = joined.mesh;
  const auto count = static_cast<std::uint32_t>(contraction.representatives.size());
  assert(count <= 32768 && contraction.parent_of.size() == mesh.own_count &&
         contraction.deviation.around.size() == count);

  // Border triangles in the new numbers; foreign corners keep theirs, moved from own_count to
  // count.
  std::vector<TileTriangle> border = images(mesh.border, [&](TileVertex v) {
    return static_cast<TileVertex>(raw(v) < mesh.own_count ? contraction.parent_of[raw(v)]
                                                           : raw(v) - mesh.own_count + count);
  });

  ContractedTile result;
  SimplifiedTile& tile = result.tile;
  const std::vector<std::uint32_t> place = boundary_first(border, count, tile.boundary_count);
  result.parent_map.resize(mesh.own_count);
  for (std::uint32_t i = 0; i < mesh.own_count; ++i) {
    result.parent_map[i] = static_cast<std::uint16_t>(place[contraction.parent_of[i]]);
  }
  for (TileTriangle& t : border) {
    t = mapped(t, [&](TileVertex v) {
      return raw(v) < count ? static_cast<TileVertex>(place[raw(v)]) : v;
    });
  }
  tile.border = std::move(border);
  tile.foreign = one_level_up(mesh.ghosts);
  normalize_triangles(tile.border, true);
  drop_unused(tile.border, tile.foreign, count);

  tile.interior = images(mesh.interior, [&](TileVertex v) {
    return static_cast<TileVertex>(result.parent_map[raw(v)]);
  });
  normalize_triangles(tile.interior, true);

  tile.vertices.channels = contraction.representatives.channels;
  std::vector<std::uint32_t> old_of(count);
  for (std::uint32_t i = 0; i < count; ++i)
    old_of[place[i]] = i;
  tile.vertices.append(contraction.representatives, old_of);

  tile.history.weights.assign(count, 0);
  for (std::uint32_t i = 0; i < mesh.own_count; ++i)
    tile.history.weights[result.parent_map[i]] += joined.history.weights[i];
  result.deviation = std::move(contraction.deviation);
  std::vector<float> around(count);
  for (std::uint32_t i = 0; i < count; ++i)
    around[place[i]] = result.deviation.around[i];
  result.deviation.around = std::move(around);
  result.fallbacks = contraction.fallbacks;
  return result;
}

ContractedTile keep(const BuildTile& tile) {
  const TileMesh& mesh = tile.mesh;
  ContractedTile result;
  result.parent_map.resize(mesh.own_count);
  for (std::uint32_t i = 0; i < mesh.own_count; ++i)
    result.parent_map[i] = static_cast<std::uint16_t>(i);
  result.tile.vertices.channels = mesh.vertices.channels;
  result.tile.vertices.append(mesh.vertices, 0, mesh.own_count);
  result.tile.history.weights = tile.history.weights;
  result.tile.boundary_count = mesh.boundary_count;
  result.tile.interior = mesh.interior;
  result.tile.border = mesh.border;
  result.tile.foreign = one_level_up(mesh.ghosts);
  normalize_triangles(result.tile.interior, true);
  normalize_triangles(result.tile.border, true);
  result.deviation.around.assign(mesh.own_count, 0);
  return result;
}

}  // namespace meshhier::cluster_simplify
