#include "gltf/sample_hierarchy.h"

#include "base/bounds.h"
#include "hierarchy/attribute_rules.h"
#include "hierarchy/value_channels.h"
#include "storage/format/tile_object_table.h"
#include "support/sample_shading.h"
#include "support/sample_texture.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

namespace meshhier::tests {
namespace {

/// Where the vertices of one level's map went: rank -> tile and number there.
struct LevelMap {
  std::vector<GhostRef> of_rank;
  std::vector<std::uint32_t> own_counts;  ///< per tile
  std::vector<std::uint32_t> boundary_counts;
};

class SampleBuilder {
 public:
  SampleBuilder(const TestMesh& mesh, const Tree& tree, const storage::TileFormat& format)
      : mesh_(mesh), tree_(tree), format_(format), levels_(raw(tree.depth()) + 1U) {}

  std::vector<PublishedTile> build() {
    for (int level = raw(tree_.depth()); level >= 0; --level)
      map_level(static_cast<Level>(level));
    std::vector<PublishedTile> tiles;
    for (int level = 0; level <= raw(tree_.depth()); ++level) {
      for (std::uint32_t i = 0; i < tree_.node_count(static_cast<Level>(level)); ++i) {
        const NodeId node{static_cast<Level>(level), i};
        if (!tree_.is_early(node))
          tiles.push_back(make_tile(node));
      }
    }
    return tiles;
  }

 private:
  LevelMap& at(Level level) { return levels_[raw(level)]; }

  void map_level(Level level) {
    LevelMap& map = at(level);
    map.own_counts.assign(tree_.node_count(level), 0);
    map.boundary_counts.assign(tree_.node_count(level), 0);
    map.of_rank.resize(mesh_.positions.size());
    for (std::size_t rank = 0; rank < map.of_rank.size(); ++rank)
      map.of_rank[rank] = contract(level, rank);
    for (const GhostRef& ref : map.of_rank) {
      map.own_counts[ref.tile] = std::max(map.own_counts[ref.tile], ref.index + 1);
    }
    boundary_first(level);
  }

  /// The vertex that stands for `rank`, before the boundary comes first.
  GhostRef contract(Level level, std::size_t rank) {
    if (level == tree_.depth()) {
      const std::uint32_t partition = raw(tree_.partition_of(rank));
      const auto begin = tree_.ranks(PartitionRange{partition, partition + 1}).begin;
      return {partition, static_cast<std::uint32_t>(rank - begin)};
    }
    const GhostRef below = at(finer(level)).of_rank[rank];
    const NodeId parent = tree_.parent({finer(level), below.tile});
    if (tree_.is_early(parent))
      return {parent.index, below.index};
    const NodeId first = tree_.children(parent).nodes[0];
    const bool second = first.index != below.tile;
    const std::uint32_t joined =
        below.index + (second ? at(finer(level)).own_counts[first.index] : 0);
    return {parent.index, joined / 2};
  }

  void boundary_first(Level level) {
    LevelMap& map = at(level);
    std::vector<GhostRef> boundary;
    for (const MeshTriangle& t : mesh_.triangles) {
      const GhostRef a = map.of_rank[t[0]], b = map.of_rank[t[1]], c = map.of_rank[t[2]];
      const bool degenerate = a == b || b == c || c == a;
      if (!degenerate && (a.tile != b.tile || b.tile != c.tile))
        boundary.insert(boundary.end(), {a, b, c});
    }
    std::sort(boundary.begin(), boundary.end());
    boundary.erase(std::unique(boundary.begin(), boundary.end()), boundary.end());
    for (const GhostRef& ref : boundary)
      ++map.boundary_counts[ref.tile];
    for (GhostRef& ref : map.of_rank) {
      if (tree_.is_early({level, ref.tile}))
        continue;  // numbered as its partition
      const auto first = std::lower_bound(boundary.begin(), boundary.end(), GhostRef{ref.tile, 0});
      const auto place = std::lower_bound(boundary.begin(), boundary.end(), ref);
      const auto before = static_cast<std::uint32_t>(place - first);
      const bool on_boundary = place != boundary.end() && *place == ref;
      ref.index = on_boundary ? before : map.boundary_counts[ref.tile] + ref.index - before;
    }
  }

  PublishedTile make_tile(NodeId node) {
    PublishedTile tile;
    tile.node = node;
    tile.mesh.own_count = at(node.level).own_counts[node.index];
    tile.mesh.boundary_count = at(node.level).boundary_counts[node.index];
    find_ghosts(tile);
    add_triangles(tile);
    add_vertices(tile);
    if (node != tree_.root())
      add_parent_map(tile);
    return tile;
  }

  /// Calls visit with the images of the corners of every triangle that touches the tile.
  template <class Visit>
  void each_triangle(NodeId node, Visit&& visit) {
    const LevelMap& map = at(node.level);
    for (const MeshTriangle& t : mesh_.triangles) {
      const std::array<GhostRef, 3> corners{map.of_rank[t[0]], map.of_rank[t[1]],
                                            map.of_rank[t[2]]};
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
        continue;
      const auto is_own = [&](const GhostRef& ref) { return ref.tile == node.index; };
      if (std::any_of(corners.begin(), corners.end(), is_own))
        visit(t, corners);
    }
  }

  void find_ghosts(PublishedTile& tile) {
    std::map<GhostRef, std::uint32_t> ghosts;  // -> a rank it stands for
    each_triangle(tile.node, [&](const MeshTriangle& t, const std::array<GhostRef, 3>& corners) {
      for (std::size_t c = 0; c < 3; ++c) {
        if (corners[c].tile != tile.node.index)
          ghosts.emplace(corners[c], t[c]);
      }
    });
    for (const auto& [ref, rank] : ghosts) {
      tile.mesh.ghosts.push_back(ref);
      std::vector<std::uint16_t> chain;
      const int length = tree_.chain_length(tile.node, {tile.node.level, ref.tile});
      for (int k = 0; k < length; ++k) {
        const auto& map = levels_[static_cast<std::size_t>(raw(tile.node.level) - k)];
        chain.push_back(static_cast<std::uint16_t>(map.of_rank[rank].index));
      }
      tile.chains.add(chain);
    }
  }

  void add_triangles(PublishedTile& tile) {
    const auto number = [&](const GhostRef& ref) {
      if (ref.tile == tile.node.index)
        return static_cast<TileVertex>(ref.index);
      const auto& ghosts = tile.mesh.ghosts;
      const auto place = std::lower_bound(ghosts.begin(), ghosts.end(), ref) - ghosts.begin();
      return static_cast<TileVertex>(tile.mesh.own_count + place);
    };
    each_triangle(tile.node, [&](const MeshTriangle&, const std::array<GhostRef, 3>& corners) {
      const bool interior =
          corners[0].tile == corners[1].tile && corners[1].tile == corners[2].tile;
      (interior ? tile.mesh.interior : tile.mesh.border)
          .push_back({number(corners[0]), number(corners[1]), number(corners[2])});
    });
    normalize_triangles(tile.mesh.interior, false);
    normalize_triangles(tile.mesh.border, false);
  }

  void add_vertices(PublishedTile& tile) {
    const auto channels = static_cast<std::size_t>(format_.attributes.channels());
    std::map<GhostRef, std::vector<std::uint32_t>> ranks;
    for (std::uint32_t rank = 0; rank < mesh_.positions.size(); ++rank) {
      ranks[at(tile.node.level).of_rank[rank]].push_back(rank);
    }
    tile.mesh.vertices.channels = format_.attributes.channels();
    const auto add = [&](const GhostRef& ref) {
      Vec3d position;
      std::vector<float> sums(channels);
      const auto& group = ranks.at(ref);
      for (const std::uint32_t rank : group) {
        position = position + to_double(mesh_.positions[rank]);
        const auto one = sample_attributes(format_.attributes, rank);
        for (std::size_t c = 0; c < channels; ++c)
          sums[c] += one[c] / static_cast<float>(group.size());
      }
      AttributeRules(format_.attributes).normalize(sums);
      tile.mesh.vertices.append(to_float(position * (1.0 / static_cast<double>(group.size()))),
                                sums);
    };
    for (std::uint32_t v = 0; v < tile.mesh.own_count; ++v)
      add({tile.node.index, v});
    for (const GhostRef& ref : tile.mesh.ghosts)
      add(ref);
  }

  void add_parent_map(PublishedTile& tile) {
    NodeId parent = tree_.parent(tile.node);
    if (tree_.is_early(parent))
      parent = tree_.parent(parent);
    tile.parent_map.resize(tile.mesh.own_count);
    for (std::size_t rank = 0; rank < mesh_.positions.size(); ++rank) {
      const GhostRef own = at(tile.node.level).of_rank[rank];
      if (own.tile != tile.node.index)
        continue;
      tile.parent_map[own.index] = static_cast<std::uint16_t>(at(parent.level).of_rank[rank].index);
    }
  }

  const TestMesh& mesh_;
  const Tree& tree_;
  const storage::TileFormat& format_;
  std::vector<LevelMap> levels_;
};

/// Gives own place p p modulo 4 copies, and some ghosts one.
class CopyMaker {
 public:
  CopyMaker(TileMesh& mesh, const AttributeLayout& layout) : mesh_(mesh), layout_(layout) {}

  void run(bool is_partition) {
    choose_wedges(mesh_.interior, mesh_.interior_wedges);
    choose_wedges(mesh_.border, mesh_.border_wedges);
    if (is_partition)
      add_flat_triangles();
    normalize_triangles(mesh_.interior, mesh_.interior_wedges, false);
    normalize_triangles(mesh_.border, mesh_.border_wedges, false);
    add_copies();
  }

 private:
  std::uint32_t copies_of(std::uint32_t place) const {
    return place < mesh_.own_count ? place % 4
                                   : static_cast<std::uint32_t>(used_ghosts_.count(place));
  }

  void choose_wedges(const std::vector<TileTriangle>& triangles,
                     std::vector<CornerWedges>& wedges) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      CornerWedges& chosen = wedges.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t place = raw(triangles[t][c]);
        const bool own = place < mesh_.own_count;
        chosen[c] = static_cast<std::uint32_t>(t + c) % (own ? place % 4 + 1 : 1 + place % 2);
        if (!own && chosen[c] > 0)
          used_ghosts_.insert(place);
      }
    }
  }

  void add_flat_triangles() {
    if (mesh_.own_count < 2)
      return;
    mesh_.interior.push_back({TileVertex{1}, TileVertex{1}, TileVertex{0}});
    mesh_.interior_wedges.push_back({1, 0, 0});
    if (mesh_.boundary_count < 2 || mesh_.ghosts.empty())
      return;
    mesh_.border.push_back(
        {TileVertex{1}, static_cast<TileVertex>(mesh_.own_count), TileVertex{1}});
    mesh_.border_wedges.push_back({1, 0, 0});
  }

  void add_copies() {
    mesh_.copies.vertices.channels = mesh_.vertices.channels;
    for (std::uint32_t place = 0; place < mesh_.vertices.size(); ++place) {
      const Vec3f p = mesh_.vertices.positions[place];
      const Vec3f same{p.x == 0 ? -p.x : p.x, p.y == 0 ? -p.y : p.y, p.z == 0 ? -p.z : p.z};
      for (std::uint32_t k = 0; k < copies_of(place); ++k) {
        mesh_.copies.vertices.append(same, sample_attributes(layout_, 1000 * place + k));
        mesh_.copies.places.push_back(place);
      }
    }
    if (!mesh_.copies.empty())
      return;
    mesh_.interior_wedges.clear();
    mesh_.border_wedges.clear();
  }

  TileMesh& mesh_;
  const AttributeLayout& layout_;
  std::set<std::uint32_t> used_ghosts_;
};

}  // namespace

const PublishedTile& SampleHierarchy::tile(NodeId node) const {
  if (tree.is_early(node))
    node = tree.children(node).nodes[0];
  return *std::lower_bound(tiles.begin(), tiles.end(), node,
                           [](const PublishedTile& t, NodeId key) { return t.node < key; });
}

SampleHierarchy make_sample(const TestMesh& mesh, std::uint32_t partitions,
                            const storage::TileFormat& format) {
  SampleHierarchy sample{Tree(mesh.positions.size(), partitions), format, {}};
  sample.tiles = SampleBuilder(mesh, sample.tree, sample.format).build();
  return sample;
}

SampleHierarchy with_copies(SampleHierarchy sample) {
  for (PublishedTile& tile : sample.tiles)
    CopyMaker(tile.mesh, sample.format.attributes).run(sample.tree.is_partition(tile.node));
  return sample;
}

SampleHierarchy textured(SampleHierarchy sample, const TextureFormat& format, AlphaMode alpha) {
  sample.format.textures = format;
  for (PublishedTile& tile : sample.tiles)
    add_texture(tile, sample_image(stored_format(format, alpha), alpha));
  return sample;
}

SampleHierarchy with_relief(SampleHierarchy sample, ImageFormat pictures, ImageFormat maps,
                            AlphaMode alpha) {
  sample = textured(std::move(sample), {pictures, 80, false}, alpha);
  sample.format.normal_maps = NormalMapFormat{maps, 80};
  for (PublishedTile& tile : sample.tiles) {
    if (!sample.tree.is_partition(tile.node) && !tile.image.empty())
      add_relief(tile, sample_image(maps));
  }
  return sample;
}

SampleHierarchy shaded(SampleHierarchy sample) {
  sample.format.computed_normals = true;
  for (PublishedTile& tile : sample.tiles)
    tile.shading = sample_shading(tile);
  return sample;
}

ObjectRow sample_object(std::uint32_t object, const std::vector<ObjectProperty>& properties) {
  ObjectRow row;
  row.name = "Gebäude/" + std::to_string(object);
  for (const ObjectProperty& property : properties) {
    const std::uint32_t which = object % 3;
    row.values.emplace_back();
    if (which == 0)
      continue;
    if (property.type == ObjectPropertyType::number)
      row.values.back() = object / 7.0;
    else if (property.type == ObjectPropertyType::boolean)
      row.values.back() = which == 1;
    else
      row.values.back() = std::string(which == 1 ? 1 : 200, 'x') + "é€";
  }
  return row;
}

SampleHierarchy with_objects(SampleHierarchy sample,
                             const std::vector<ObjectProperty>& properties) {
  sample.format.objects = properties;
  const PlacedValue object = placed_object(sample.format.attributes).value();
  for (PublishedTile& tile : sample.tiles) {
    constexpr double kNumber = 16777000;
    for (VertexArray* vertices : {&tile.mesh.vertices, &tile.mesh.copies.vertices}) {
      const auto channels = static_cast<std::size_t>(vertices->channels);
      for (std::size_t v = 0; v < vertices->size(); ++v)
        put_value(object.type, kNumber - static_cast<double>(v % 23 * 1000),
                  vertices->attributes.data() + v * channels + object.channel);
    }
    tile.objects = storage::make_tile_objects(
        storage::objects_of(tile.mesh, sample.format.attributes), properties,
        [&](std::uint32_t one) { return sample_object(one, properties); });
  }
  return sample;
}

SampleHierarchy quantized(SampleHierarchy sample, int bits) {
  Bounds bounds;
  for (const PublishedTile& tile : sample.tiles)
    bounds.add(bounds_of(tile.mesh.vertices.positions));
  sample.format.lattice = make_lattice(bounds, bits);
  for (PublishedTile& tile : sample.tiles) {
    round_to(*sample.format.lattice, tile.mesh.vertices.positions);
    round_to(*sample.format.lattice, tile.mesh.copies.vertices.positions);
  }
  return sample;
}

std::vector<float> sample_attributes(const AttributeLayout& layout, std::uint64_t vertex) {
  std::vector<float> channels;
  if (layout.normals) {
    const Vec3d n{hash_noise(vertex, 1) + 2.0, hash_noise(vertex, 2), hash_noise(vertex, 3)};
    const Vec3f unit = to_float(n * (1 / length(n)));
    for (const float axis : {unit.x, unit.y, unit.z})
      channels.push_back(axis);
  }
  const float top = layout.colour == ColourType::u8    ? 255.0F
                    : layout.colour == ColourType::u16 ? 65535.0F
                                                       : 1.0F;
  for (int c = 0; c < layout.colour_channels(); ++c) {
    const float part = std::abs(hash_noise(vertex, 4 + static_cast<std::uint64_t>(c)));
    channels.push_back(layout.colour == ColourType::f32 ? part : std::round(part * top));
  }
  channels.insert(channels.end(), static_cast<std::size_t>(layout.value_channels()), 0.0F);
  for (std::uint64_t i = 0; layout.texcoords && i < 2; ++i)
    channels.push_back(3 * hash_noise(vertex, 8 + i));
  return channels;
}

std::vector<AttributeLayout> sample_layouts() {
  std::vector<AttributeLayout> layouts{{}, {.normals = true}, {.texcoords = true}};
  for (const ColourType type : {ColourType::u8, ColourType::u16, ColourType::f32}) {
    for (const bool alpha : {false, true}) {
      layouts.push_back({.colour = type, .alpha = alpha});
      layouts.push_back({.normals = true, .colour = type, .alpha = alpha, .texcoords = true});
    }
  }
  return layouts;
}

std::vector<AttributeLayout> sample_layouts_without_texcoords() {
  std::vector<AttributeLayout> layouts = sample_layouts();
  std::erase_if(layouts, [](const AttributeLayout& layout) { return layout.texcoords; });
  for (const ColourType type : {ColourType::u8, ColourType::f32})
    layouts.push_back({.normals = true, .colour = type, .alpha = true});
  return layouts;
}

std::vector<AttributeLayout> sample_layouts_without_normals() {
  std::vector<AttributeLayout> layouts = sample_layouts();
  std::erase_if(layouts, [](const AttributeLayout& layout) { return layout.normals; });
  for (const ColourType type : {ColourType::u8, ColourType::f32})
    layouts.push_back({.colour = type, .texcoords = true});
  return layouts;
}

}  // namespace meshhier::tests
