#include "storage/format/tile_sections.h"

#include "hierarchy/error.h"
#include "hierarchy/vertex_numbers.h"
#include "storage/format/glb.h"
#include "storage/format/tile_glb.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

/// Takes the copies from the end of a tile's vertices.
Copies take_copies(VertexArray& vertices, std::vector<std::uint32_t> places) {
  Copies copies;
  copies.vertices.channels = vertices.channels;
  copies.places = std::move(places);
  const std::size_t first = vertices.size() - copies.size();
  copies.vertices.append(vertices, first, vertices.size());
  vertices.positions.resize(first);
  vertices.attributes.resize(first * static_cast<std::size_t>(vertices.channels));
  return copies;
}

class Reader {
 public:
  Reader(const TileSections& sections, const Tree& tree, const std::string& name)
      : plan_(sections.plan),
        bin_(sections.bin),
        is_packed_(sections.is_packed),
        tree_(tree),
        name_(name) {}

  std::vector<Vec3f> positions() const {
    const Section& section = plan_[Part::position];
    std::vector<Vec3f> positions(section.count);
    for (std::size_t v = 0; v < positions.size(); ++v) {
      positions[v] = position(section, v);
      if (!std::isfinite(positions[v].x) || !std::isfinite(positions[v].y) ||
          !std::isfinite(positions[v].z)) {
        fail(fmt::format("position of vertex {} is not finite", v));
      }
      if (plan_.lattice() && plan_.lattice()->nearest(positions[v]) != positions[v])
        fail(fmt::format("position of vertex {} is not on the lattice", v));
    }
    return positions;
  }

  PublishedTile tile(std::vector<Vec3f> positions) const {
    const TileShape& shape = plan_.shape();
    PublishedTile tile;
    tile.node = shape.node;
    TileMesh& mesh = tile.mesh;
    mesh.vertices = {std::move(positions), attributes(), plan_.layout().channels()};
    mesh.own_count = static_cast<std::uint32_t>(shape.own);
    mesh.boundary_count = static_cast<std::uint32_t>(shape.boundary);
    mesh.copies = take_copies(mesh.vertices, copy_places(mesh.vertices.positions));
    const VertexNumbers numbers(static_cast<std::uint32_t>(shape.places()), mesh.copies.places);
    read_triangles(Part::interior, numbers, mesh.interior, mesh.interior_wedges);
    read_triangles(Part::border, numbers, mesh.border, mesh.border_wedges);
    tile.parent_map = parent_map();
    read_ghosts(tile);
    return tile;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::corrupt, name_ + ": " + what);
  }

  template <Scalar T>
  T get(const Section& section, std::size_t element, std::size_t component = 0) const {
    return load_little<T>(bin_.data() + section.offset + element * section.stride +
                          component * sizeof(T));
  }

  std::vector<float> attributes() const {
    const auto channels = static_cast<std::size_t>(plan_.layout().channels());
    std::vector<float> attributes(plan_.shape().vertices() * channels);
    const auto groups = groups_of(plan_.layout());
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const bool is_raw = plan_.shape().raw[i];
      read_group(groups[i], groups[i].part, true, attributes);
      if (is_raw)
        read_group(groups[i], groups[i].raw, false, attributes);
    }
    return attributes;
  }

  /// Where the copies lie. `positions`: of all vertices.
  std::vector<std::uint32_t> copy_places(std::span<const Vec3f> positions) const {
    const Section& section = plan_[Part::copy_of];
    const std::uint64_t place_count = plan_.shape().places();
    std::vector<std::uint32_t> places(section.count);
    for (std::size_t i = 0; i < places.size(); ++i) {
      places[i] = number(section, i);
      if (places[i] >= place_count || (i > 0 && places[i] < places[i - 1])) {
        fail(fmt::format("copy {} is of vertex {}, expected one of the first {}, ascending", i,
                         places[i], place_count));
      }
      if (positions[place_count + i] != positions[places[i]])
        fail(fmt::format("copy {} does not lie where its vertex {} does", i, places[i]));
    }
    return places;
  }

  /// Triangles of places, which begin with their smallest corner and ascend, and their wedges if
  /// there are copies. They must be so in the file, unless it is packed.
  void read_triangles(Part part, const VertexNumbers& numbers, std::vector<TileTriangle>& triangles,
                      std::vector<CornerWedges>& wedges) const {
    triangles = numbered_triangles(part);
    if (plan_.shape().copies > 0)
      wedges = numbers.split(triangles);
    if (is_packed_)
      normalize_triangles(triangles, wedges, false);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      check_order(part, t, triangles, wedges);
      check_corners(part, t, triangles[t]);
    }
  }

  std::vector<std::uint16_t> parent_map() const {
    return short_list(Part::parent_map, "parent map");
  }

  void read_ghosts(PublishedTile& tile) const {
    const Section& neighbours = plan_[Part::neighbours];
    const Section& starts = plan_[Part::ghost_starts];
    const std::vector<std::uint16_t> chains = short_list(Part::ghost_chains, "ghost chain");
    tile.mesh.ghosts.reserve(plan_.shape().ghosts);
    tile.chains.reserve(plan_.shape().ghosts, chains.size());
    std::span<const std::uint16_t> left = chains;
    for (std::size_t i = 0; i < neighbours.count; ++i) {
      const auto index = get<std::uint32_t>(neighbours, i);
      const bool ascends = i == 0 || index > get<std::uint32_t>(neighbours, i - 1);
      const NodeId neighbour{plan_.shape().node.level, index};
      if (!tree_.contains(neighbour) || neighbour == plan_.shape().node || !ascends) {
        fail(fmt::format(
            "neighbour {} is tile {}, which is not another one of the level, ascending", i, index));
      }
      const std::uint64_t begin = get<std::uint32_t>(starts, i);
      const std::uint64_t end = get<std::uint32_t>(starts, i + 1);
      if (begin != tile.mesh.ghosts.size() || end <= begin || end > plan_.shape().ghosts) {
        fail(fmt::format("ghosts {} to {} of neighbour {} are not a run of the {} from {} on",
                         begin, end, i, plan_.shape().ghosts, tile.mesh.ghosts.size()));
      }
      read_neighbour(neighbour, end - begin, left, tile);
    }
    if (tile.mesh.ghosts.size() != plan_.shape().ghosts || !left.empty()) {
      fail(fmt::format("the neighbours account for {} of {} ghosts and leave {} chain entries",
                       tile.mesh.ghosts.size(), plan_.shape().ghosts, left.size()));
    }
  }

  /// Takes `count` chains from the front of `left`.
  void read_neighbour(NodeId neighbour, std::size_t count, std::span<const std::uint16_t>& left,
                      PublishedTile& tile) const {
    const auto length = static_cast<std::size_t>(tree_.chain_length(tile.node, neighbour));
    const bool stays = tree_.stands_for_parent(neighbour);
    if (left.size() / length < count) {
      fail(fmt::format("tile {} needs {} chains of {} entries, {} entries are left",
                       neighbour.index, count, length, left.size()));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto chain = left.first(length);
      left = left.subspan(length);
      if (i > 0 && chain[0] <= tile.mesh.ghosts.back().index) {
        fail(
            fmt::format("ghosts of tile {} do not ascend at vertex {}", neighbour.index, chain[0]));
      }
      if (stays && length > 1 && chain[1] != chain[0]) {
        fail(fmt::format("vertex {} of tile {} changes its number to {} without a parent tile",
                         chain[0], neighbour.index, chain[1]));
      }
      tile.mesh.ghosts.push_back({neighbour.index, chain[0]});
      tile.chains.add(chain);
    }
  }

  Vec3f position(const Section& section, std::size_t v) const {
    if (!plan_.has_short_positions()) {
      return {get<float>(section, v, 0), get<float>(section, v, 1), get<float>(section, v, 2)};
    }
    return plan_.lattice()->point({get<std::uint16_t>(section, v, 0),
                                   get<std::uint16_t>(section, v, 1),
                                   get<std::uint16_t>(section, v, 2)});
  }

  /// `require_finite`: of what viewers read; raw values may be anything.
  void read_group(const ChannelGroup& group, Part part, bool require_finite,
                  std::span<float> attributes) const {
    const Section& section = plan_[part];
    const auto channels = static_cast<std::size_t>(plan_.layout().channels());
    for (std::size_t v = 0; v < section.count; ++v) {
      for (std::size_t c = 0; c < section.components; ++c) {
        float& value = attributes[v * channels + group.offset + c];
        value = section.component == kU8    ? get<std::uint8_t>(section, v, c)
                : section.component == kU16 ? get<std::uint16_t>(section, v, c)
                                            : get<float>(section, v, c);
        if (require_finite && !std::isfinite(value)) {
          fail(fmt::format("{} of vertex {} is not finite", key_of(part), v));
        }
      }
    }
  }

  std::uint32_t number(const Section& section, std::size_t element) const {
    return section.component == kU16 ? get<std::uint16_t>(section, element)
                                     : get<std::uint32_t>(section, element);
  }

  /// Of three different vertices each.
  std::vector<TileTriangle> numbered_triangles(Part part) const {
    const Section& section = plan_[part];
    std::vector<TileTriangle> triangles(section.count / 3);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t index = number(section, 3 * t + c);
        if (index >= plan_.shape().vertices()) {
          fail(fmt::format("index {} of {} triangle {} is not below the {} vertices", index,
                           key_of(part), t, plan_.shape().vertices()));
        }
        triangles[t][c] = static_cast<TileVertex>(index);
      }
      if (is_degenerate(triangles[t]))
        fail_triangle(part, t, triangles[t], "has a vertex twice");
    }
    return triangles;
  }

  void check_order(Part part, std::size_t t, std::span<const TileTriangle> triangles,
                   std::span<const CornerWedges> wedges) const {
    const auto wedges_at = [&](std::size_t i) {
      return wedges.empty() ? CornerWedges{} : wedges[i];
    };
    const auto corner = [&](std::size_t c) { return Wedge{raw(triangles[t][c]), wedges_at(t)[c]}; };
    const auto key = [&](std::size_t i) { return std::pair(triangles[i], wedges_at(i)); };
    if (corner(1) < corner(0) || corner(2) < corner(0) || (t > 0 && key(t) < key(t - 1)))
      fail_triangle(part, t, triangles[t], "is turned or out of order");
  }

  void check_corners(Part part, std::size_t t, const TileTriangle& triangle) const {
    if (is_degenerate(triangle) && !tree_.is_partition(plan_.shape().node))
      fail_triangle(part, t, triangle, "has a place twice, above the partitions");
    std::uint64_t own = 0, boundary = 0;
    for (const TileVertex corner : triangle) {
      own += raw(corner) < plan_.shape().own ? 1 : 0;
      boundary += raw(corner) < plan_.shape().boundary ? 1 : 0;
    }
    const bool fits = part == Part::interior ? own == 3 : own == boundary && (own == 1 || own == 2);
    if (!fits) {
      fail(fmt::format("{} triangle {} has {} own corners, {} of them on the boundary",
                       key_of(part), t, own, boundary));
    }
  }

  [[noreturn]] void fail_triangle(Part part, std::size_t t, const TileTriangle& triangle,
                                  const char* what) const {
    fail(fmt::format("{} triangle {} ({}, {}, {}) {}", key_of(part), t, raw(triangle[0]),
                     raw(triangle[1]), raw(triangle[2]), what));
  }

  std::vector<std::uint16_t> short_list(Part part, const char* what) const {
    const Section& section = plan_[part];
    std::vector<std::uint16_t> list(section.count);
    for (std::size_t i = 0; i < list.size(); ++i) {
      list[i] = get<std::uint16_t>(section, i);
      if (list[i] >= kMaxOwnVertices) {
        fail(fmt::format("{} entry {} is {}, expected less than {}", what, i, list[i],
                         kMaxOwnVertices));
      }
    }
    return list;
  }

  const TilePlan& plan_;
  std::span<const std::byte> bin_;
  bool is_packed_;
  const Tree& tree_;
  const std::string& name_;
};

}  // namespace

std::vector<Vec3f> read_positions(const TileSections& sections, const Tree& tree,
                                  const std::string& name) {
  return Reader(sections, tree, name).positions();
}

PublishedTile read_tile(const TileSections& sections, std::vector<Vec3f> positions,
                        const Tree& tree, const std::string& name) {
  return Reader(sections, tree, name).tile(std::move(positions));
}

}  // namespace meshhier::storage
