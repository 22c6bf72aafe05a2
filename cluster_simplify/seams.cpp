#include "cluster_simplify/seams.h"

#include "base/error.h"
#include "cluster_simplify/seam_wedges.h"
#include "cluster_simplify/wedges.h"

#include <algorithm>
#include <array>
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
BuildTile resolve(WorkTile<Corner> tile, std::span<const GhostRef> mapped_refs, bool unique,
                  std::uint32_t own_index) {
  assert(mapped_refs.size() == tile.foreign.size());
  const auto own_count = static_cast<std::uint32_t>(tile.vertices.size());
  std::vector<GhostRef> ghosts(mapped_refs.begin(), mapped_refs.end());
  // Several corners of the finer level may have one parent now: they become one ghost, and
  // triangles between them lose their area.
  const std::vector<std::uint32_t> place = make_unique(ghosts);
  for (TileTriangle& t : tile.border) {
    t = mapped(t, [&](TileVertex v) {
      return raw(v) < own_count ? v
                                : static_cast<TileVertex>(own_count + place[raw(v) - own_count]);
    });
  }
  // Triangles of equal places may differ in their wedges. Which one stays must not depend on this
  // tile's numbers: the neighbours number the same corners otherwise.
  if (unique && !tile.border_wedges.empty()) {
    keep_one_of_places(tile.border, tile.border_wedges, [&](TileVertex v) {
      return raw(v) < own_count ? GhostRef{own_index, raw(v)} : ghosts[raw(v) - own_count];
    });
  } else {
    normalize_triangles(tile.border, tile.border_wedges, unique);
  }
  drop_unused(tile.border, ghosts, own_count);  // order-preserving: the triangles stay sorted

  BuildTile result;
  result.mesh = {.vertices = std::move(tile.vertices),
                 .own_count = own_count,
                 .boundary_count = tile.boundary_count,
                 .ghosts = std::move(ghosts),
                 .interior = std::move(tile.interior),
                 .border = std::move(tile.border),
                 .copies = std::move(tile.copies),
                 .ghost_wedges = {},
                 .interior_wedges = std::move(tile.interior_wedges),
                 .border_wedges = std::move(tile.border_wedges)};
  result.history = std::move(tile.history);
  number_ghost_wedges(result.mesh);
  return result;
}

template BuildTile resolve(LeafTile, std::span<const GhostRef>, bool, std::uint32_t);
template BuildTile resolve(SimplifiedTile, std::span<const GhostRef>, bool, std::uint32_t);

void fill_ghosts(BuildTile& tile, std::uint32_t neighbour, const Boundary& boundary) {
  const auto& ghosts = tile.mesh.ghosts;
  // Ghosts ascend by name, so one neighbour's are a run. Taken neighbour by neighbour, ghost i
  // becomes vertex own_count + i, as border triangles number it.
  auto ghost = std::lower_bound(ghosts.begin(), ghosts.end(), GhostRef{neighbour, 0});
  std::vector<std::uint32_t> named;
  for (; ghost != ghosts.end() && ghost->tile == neighbour; ++ghost) {
    if (ghost->index >= boundary.vertices.size())
      throw Error(ErrorCode::internal, "a ghost lies outside its tile's boundary");
    named.push_back(ghost->index);
  }
  tile.mesh.vertices.append(boundary.vertices, named);
  fill_ghost_copies(tile.mesh, boundary);
}

namespace {

/// One of two tiles that are joined.
struct JoinedSide {
  const TileMesh& mesh;
  std::uint32_t sibling;         ///< the other one's index
  std::uint32_t offset;          ///< number of its first own vertex in the joined tile
  std::uint32_t sibling_offset;  ///< of the other one's
};

/// Appends the ghosts that belong to neither of the two; one that both have becomes one.
void append_ghosts(const JoinedSide& a, const JoinedSide& b, TileMesh& joined) {
  struct Outside {
    GhostRef ref;
    const TileMesh* tile;
    std::uint32_t vertex;
  };
  std::vector<Outside> outside;
  for (const JoinedSide* side : {&a, &b}) {
    const TileMesh& tile = side->mesh;
    for (std::uint32_t i = 0; i < tile.ghosts.size(); ++i) {
      if (tile.ghosts[i].tile != side->sibling)
        outside.push_back({tile.ghosts[i], &tile, tile.own_count + i});
    }
  }
  // Both read it from the same neighbour's boundary, so the first one's is as good as the other's.
  std::stable_sort(outside.begin(), outside.end(),
                   [](const Outside& x, const Outside& y) { return x.ref < y.ref; });
  outside.erase(std::unique(outside.begin(), outside.end(),
                            [](const Outside& x, const Outside& y) { return x.ref == y.ref; }),
                outside.end());
  for (const Outside& ghost : outside) {
    joined.ghosts.push_back(ghost.ref);
    joined.vertices.append(ghost.tile->vertices, ghost.vertex, ghost.vertex + 1);
  }
}

/// Returns the numbers of a tile's vertices in the joined one. A ghost in the sibling is a boundary
/// vertex there, and those are its first own vertices: its index is its number.
std::vector<TileVertex> joined_numbers(const JoinedSide& side, const TileMesh& joined) {
  const TileMesh& tile = side.mesh;
  std::vector<TileVertex> numbers(tile.vertices.size());
  for (std::uint32_t i = 0; i < tile.own_count; ++i)
    numbers[i] = static_cast<TileVertex>(side.offset + i);
  for (std::uint32_t i = 0; i < tile.ghosts.size(); ++i) {
    const GhostRef& ref = tile.ghosts[i];
    const auto found = std::lower_bound(joined.ghosts.begin(), joined.ghosts.end(), ref);
    numbers[tile.own_count + i] = static_cast<TileVertex>(
        ref.tile == side.sibling
            ? side.sibling_offset + ref.index
            : joined.own_count + static_cast<std::uint32_t>(found - joined.ghosts.begin()));
  }
  return numbers;
}

/// Appends interior triangles, whose corners move by as much as the tiles before have.
void append_interior(const JoinedSide& side, bool has_copies, TileMesh& joined) {
  const TileMesh& tile = side.mesh;
  for (const TileTriangle& t : tile.interior)
    joined.interior.push_back(
        mapped(t, [&](TileVertex v) { return static_cast<TileVertex>(raw(v) + side.offset); }));
  if (has_copies)
    append_wedges(tile.interior.size(), tile.interior_wedges, joined.interior_wedges);
}

/// Appends border triangles. One between the two alone has own corners only by now: nobody else
/// needs it to stay as it is, and the contraction may change it as any other.
void append_border(const JoinedSide& side, bool has_copies, TileMesh& joined) {
  const std::vector<TileVertex> numbers = joined_numbers(side, joined);
  for (std::size_t i = 0; i < side.mesh.border.size(); ++i) {
    const TileTriangle placed =
        mapped(side.mesh.border[i], [&](TileVertex v) { return numbers[raw(v)]; });
    // A triangle that touches both is a border triangle of both: it came with the first tile.
    if (std::ranges::any_of(placed, [&](TileVertex v) { return raw(v) < side.offset; }))
      continue;
    const bool inside =
        std::ranges::all_of(placed, [&](TileVertex v) { return raw(v) < joined.own_count; });
    (inside ? joined.interior : joined.border).push_back(placed);
    if (has_copies)
      (inside ? joined.interior_wedges : joined.border_wedges)
          .push_back(joined_wedges(side.mesh, i, placed, joined));
  }
}

}  // namespace

BuildTile join(const BuildTile& first, std::uint32_t first_index, const BuildTile& second,
               std::uint32_t second_index) {
  const TileMesh& a = first.mesh;
  const TileMesh& b = second.mesh;
  BuildTile joined;
  TileMesh& mesh = joined.mesh;
  mesh.own_count = a.own_count + b.own_count;
  mesh.vertices.channels = a.vertices.channels;
  mesh.vertices.reserve(mesh.own_count + a.ghosts.size() + b.ghosts.size());
  mesh.vertices.append(a.vertices, 0, a.own_count);
  mesh.vertices.append(b.vertices, 0, b.own_count);
  joined.history.weights = first.history.weights;
  joined.history.weights.insert(joined.history.weights.end(), second.history.weights.begin(),
                                second.history.weights.end());

  const std::array<JoinedSide, 2> sides{JoinedSide{a, second_index, 0, a.own_count},
                                        JoinedSide{b, first_index, a.own_count, 0}};
  append_ghosts(sides[0], sides[1], mesh);
  const bool has_copies = !a.copies.empty() || !b.copies.empty();
  if (has_copies)
    join_copies(a, second_index, b, first_index, mesh);
  mesh.interior.reserve(a.interior.size() + b.interior.size() + a.border.size());
  for (const JoinedSide& side : sides)
    append_interior(side, has_copies, mesh);
  for (const JoinedSide& side : sides)
    append_border(side, has_copies, mesh);
  if (has_copies) {
    drop_degenerate(mesh.interior, mesh.interior_wedges);
    drop_degenerate(mesh.border, mesh.border_wedges);
  }
  return joined;  // an outside ghost has its border triangle, but for those of flat ones
}

namespace {

/// New numbers for representatives: those of border triangles first, order kept otherwise. First,
/// because other tiles name them: names and the files' parts that they read stay short.
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

/// A vertex weighs as many of the input's as it stands for: sums keep the total, level by level.
std::vector<float> summed_weights(std::span<const float> weights,
                                  std::span<const std::uint16_t> parent_map, std::uint32_t count) {
  std::vector<float> sums(count, 0);
  for (std::size_t i = 0; i < parent_map.size(); ++i)
    sums[parent_map[i]] += weights[i];
  return sums;
}

/// Puts the representatives in their new order, and what is known of each.
void take_representatives(Contraction contraction, std::span<const std::uint32_t> place,
                          ContractedTile& result) {
  SimplifiedTile& tile = result.tile;
  tile.vertices.channels = contraction.representatives.channels;
  tile.copies.vertices.channels = tile.vertices.channels;
  result.deviation = std::move(contraction.deviation);
  std::vector<std::uint32_t> old_of(place.size());
  std::vector<float> around(place.size());
  for (std::uint32_t i = 0; i < place.size(); ++i) {
    old_of[place[i]] = i;
    around[place[i]] = result.deviation.around[i];
  }
  tile.vertices.append(contraction.representatives, old_of);
  result.deviation.around = std::move(around);
  result.fallbacks = contraction.fallbacks;
}

}  // namespace

ContractedTile apply(const BuildTile& joined, Contraction contraction, ContractedWedges wedges) {
  const TileMesh& mesh = joined.mesh;
  const auto count = static_cast<std::uint32_t>(contraction.representatives.size());
  // Two such tiles join to 65,536 places at most, which a parent map numbers with 16 bits.
  assert(count <= 32768 && contraction.parent_of.size() == mesh.own_count &&
         contraction.deviation.around.size() == count);

  // Border triangles in the new numbers; foreign corners keep theirs, moved from own_count to
  // count.
  ContractedTile result;
  SimplifiedTile& tile = result.tile;
  tile.border = images(mesh.border, [&](TileVertex v) {
    return static_cast<TileVertex>(raw(v) < mesh.own_count ? contraction.parent_of[raw(v)]
                                                           : raw(v) - mesh.own_count + count);
  });
  // Only now is it known which representatives the border still uses; those get the first numbers.
  const std::vector<std::uint32_t> place = boundary_first(tile.border, count, tile.boundary_count);
  // The map leads through both changes at once. Neighbours name corners by it in resolve(), so that
  // they never need to know what this contraction did.
  result.parent_map.resize(mesh.own_count);
  for (std::uint32_t i = 0; i < mesh.own_count; ++i) {
    result.parent_map[i] = static_cast<std::uint16_t>(place[contraction.parent_of[i]]);
  }
  for (TileTriangle& t : tile.border) {
    t = mapped(t, [&](TileVertex v) {
      return raw(v) < count ? static_cast<TileVertex>(place[raw(v)]) : v;
    });
  }
  tile.interior = images(mesh.interior, [&](TileVertex v) {
    return static_cast<TileVertex>(result.parent_map[raw(v)]);
  });
  tile.foreign = one_level_up(mesh.ghosts);
  const bool has_wedges = !wedges.map.firsts.empty();
  if (has_wedges) {
    tile.copies = renumbered(wedges.copies, place);
    contraction.representatives.attributes = std::move(wedges.attributes);
    result.wedge_map = std::move(wedges.map);
    tile.border_wedges = wedges_of_images(mesh, mesh.border, mesh.border_wedges, result);
    if (!tile.copies.empty())
      tile.interior_wedges = wedges_of_images(mesh, mesh.interior, mesh.interior_wedges, result);
  }
  // Equal triangles go, on the border too. A neighbour that has them keeps them until resolve(),
  // where the corners that became one here become one for it.
  // Triangles that differ by their wedges wait for resolve(), which knows all corners' names.
  normalize_triangles(tile.border, tile.border_wedges, tile.border_wedges.empty());
  drop_equal(tile.border, tile.border_wedges);
  drop_unused(tile.border, tile.foreign, count);
  normalize_triangles(tile.interior, tile.interior_wedges, true);
  if (has_wedges)
    tile.interior_wedges.resize(tile.interior.size());  // without copies the first of each place

  tile.history.weights = summed_weights(joined.history.weights, result.parent_map, count);
  take_representatives(std::move(contraction), place, result);
  return result;
}

ContractedTile apply(const BuildTile& joined, Contraction contraction) {
  assert(joined.mesh.copies.empty());
  return apply(joined, std::move(contraction), {});
}

ContractedTile keep(const BuildTile& tile) {
  const TileMesh& mesh = tile.mesh;
  ContractedTile result;
  result.parent_map.resize(mesh.own_count);
  for (std::uint32_t i = 0; i < mesh.own_count; ++i)
    result.parent_map[i] = static_cast<std::uint16_t>(i);
  result.tile.vertices.channels = mesh.vertices.channels;
  result.tile.copies.vertices.channels = mesh.vertices.channels;
  result.tile.vertices.append(mesh.vertices, 0, mesh.own_count);
  result.tile.history.weights = tile.history.weights;
  result.tile.boundary_count = mesh.boundary_count;
  result.tile.interior = mesh.interior;
  result.tile.border = mesh.border;
  result.tile.foreign = one_level_up(mesh.ghosts);
  if (!mesh.copies.empty()) {
    const std::size_t own_copies = mesh.copies.first_of(mesh.own_count);
    result.tile.copies.places.assign(
        mesh.copies.places.begin(),
        mesh.copies.places.begin() + static_cast<std::ptrdiff_t>(own_copies));
    result.tile.copies.vertices.append(mesh.copies.vertices, 0, own_copies);
    result.tile.interior_wedges = mesh.interior_wedges;
    result.tile.border_wedges = mesh.border_wedges;
    name_ghost_wedges(mesh, result.tile.border_wedges);
  }
  normalize_triangles(result.tile.interior, result.tile.interior_wedges, true);
  // As apply() does, so that all neighbours choose the same ones in resolve().
  if (!result.tile.border_wedges.empty())
    drop_degenerate(result.tile.border, result.tile.border_wedges);
  normalize_triangles(result.tile.border, result.tile.border_wedges,
                      result.tile.border_wedges.empty());
  drop_equal(result.tile.border, result.tile.border_wedges);
  result.deviation.around.assign(mesh.own_count, 0);
  return result;
}

}  // namespace meshhier::cluster_simplify
