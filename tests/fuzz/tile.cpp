// The input of the target `tile`, little endian:
//
//   u32, u32              the tree, see take_tree()
//   u8  level             of the node, modulo what there can be
//   u32 index             likewise
//   u8  format            1 normals, 2 alpha, 4 texcoords, 8 an origin; 16, 32: the colours' type;
//                         64, 128: the compression; with 64 and 8, positions are on a lattice;
//                         2 without 1 and colours: computed normals; 1 and 2 without colours: a
//                         textured tile, of which one more byte tells:
//   u8  textures          1, 2: the pictures' format; 4 unlit, 8 colours; 16 normals, computed with
//                         32; 64: normal maps instead
//
// and then a GLB (put into a gzip stream where one is wanted), or a gzip stream, or, if it begins
// like neither, what makes a GLB: counts whose JSON is written as it must be, so that all the rest
// of the input lies behind the comparison of the JSON:
//
//   u16 own, boundary, ghosts, neighbours, chain entries, interior, border, copies; splits only if
//       there are computed normals or textures
//   u8  which attributes have raw values: 1, 2, 4, 8
//   u16 bytes of the picture, u8 width, u8 height, u8 alpha, all one less and modulo what they can
//       be: only of a textured tile with triangles; of a hierarchy with normal maps a u8 first,
//       whose 1 says that the tile has one
//   the BIN chunk before it is compressed, cut or filled up with zeros to its size
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "hierarchy/vertex_numbers.h"
#include "storage/format/glb.h"
#include "storage/format/gzip.h"
#include "storage/format/tile_glb.h"
#include "storage/format/tile_pack.h"
#include "storage/format/tile_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::tests::fuzz {
namespace {

using storage::TileFormat;

struct Place {
  Tree tree;
  NodeId node;
  TileFormat format;
};

void take_textures(Take& take, TileFormat& format) {
  const auto bits = take.number<std::uint8_t>();
  const bool computed = (bits & 48) == 48;
  format.textures = TextureFormat{static_cast<ImageFormat>((bits & 3) % 3), 90, (bits & 4) != 0};
  format.attributes = {(bits & 48) == 16, (bits & 8) != 0 ? ColourType::u8 : ColourType::none};
  format.computed_normals = computed;
  if ((bits & 64) != 0) {
    format.normal_maps = NormalMapFormat{format.textures->format, 90};
    format.textures.reset();
  }
}

Place take_place(Take& take) {
  Place place{take_tree(take), {}, {}};
  place.node.level = static_cast<Level>(take.upto<std::uint8_t>(raw(place.tree.depth())));
  place.node.index = take.upto<std::uint32_t>(place.tree.node_count(place.node.level) - 1);
  const auto bits = take.number<std::uint8_t>();
  const bool computed = (bits & 51) == 2;
  place.format.attributes = {(bits & 1) != 0, static_cast<ColourType>(bits >> 4 & 3),
                             (bits & 2) != 0 && !computed, (bits & 4) != 0};
  place.format.computed_normals = computed;
  if ((bits & 8) != 0 && place.format.attributes.colour != ColourType::none)
    place.format.attributes.space = ColourSpace::linear;
  if ((bits & 51) == 3)
    take_textures(take, place.format);
  if ((bits & 8) != 0)
    place.format.frame.origin = {1e6, -0.1, 3};
  place.format.compression = static_cast<storage::Compression>(bits >> 6);
  if ((bits & 64) != 0 && (bits & 8) != 0)
    place.format.lattice = Lattice{(bits & 128) != 0 ? 12 : 20, 0.25, {-8, 0, 100}};
  return place;
}

/// The box of the positions in the BIN chunk; false if one is not finite: no box has a JSON.
bool bounds_in(Bytes bin, const storage::TilePlan& plan, Bounds& bounds) {
  for (std::size_t v = 0; v < plan.shape().with_splits(); ++v) {
    if (plan.has_short_positions()) {
      Take numbers(bin.subspan(8 * v));
      const auto x = numbers.number<std::uint16_t>();
      const auto y = numbers.number<std::uint16_t>();
      bounds.add(plan.lattice()->point({x, y, numbers.number<std::uint16_t>()}));
      continue;
    }
    Take take(bin.subspan(12 * v));
    Vec3f position;
    position.x = take.number<float>();
    position.y = take.number<float>();
    position.z = take.number<float>();
    if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z))
      return false;
    bounds.add(position);
  }
  return true;
}

/// Returns whether all corners of triangles are vertices or splits, as the encoder requires.
bool has_vertices_below(const storage::TilePlan& plan, Bytes bin) {
  for (const storage::TilePart part : {storage::TilePart::interior, storage::TilePart::border}) {
    const storage::Section& section = plan[part];
    Take take(bin.subspan(section.offset, section.bytes()));
    for (std::uint64_t i = 0; i < section.count; ++i) {
      const std::uint32_t corner =
          section.stride == 2 ? take.number<std::uint16_t>() : take.number<std::uint32_t>();
      if (corner >= plan.shape().with_splits())
        return false;
    }
  }
  return true;
}

storage::ImageShape take_image(Take& take) {
  storage::ImageShape image;
  image.bytes = take.number<std::uint16_t>() + std::uint64_t{1};
  image.width = take.number<std::uint8_t>() + 1U;
  image.height = take.number<std::uint8_t>() + 1U;
  image.alpha = static_cast<AlphaMode>(take.upto<std::uint8_t>(2));
  return image;
}

/// A GLB of the counts at the front; empty if they ask for more than an input can fill.
std::vector<std::byte> make_glb(Take take, const Place& place) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 17;
  const auto count = [&] { return std::uint64_t{take.number<std::uint16_t>()}; };
  storage::TileShape shape;
  shape.node = place.node;
  for (std::uint64_t* field : {&shape.own, &shape.boundary, &shape.ghosts, &shape.neighbours,
                               &shape.chain_entries, &shape.interior, &shape.border, &shape.copies})
    *field = count();
  shape.computed_normals = place.format.computed_normals;
  shape.textures = place.format.textures;
  shape.normal_maps = place.format.normal_maps;
  if (shape.is_shaded())
    shape.splits = count();
  const auto raw_bits = take.number<std::uint8_t>();
  const auto groups = storage::groups_of(place.format.attributes);
  for (std::size_t i = 0; i < groups.size(); ++i)
    shape.raw[i] = groups[i].channels > 0 && (raw_bits >> i & 1) != 0;
  shape.raw_values = !place.format.attributes.values.empty() && (raw_bits & 8) != 0;
  if (shape.textures && shape.interior + shape.border > 0)
    shape.image = take_image(take);
  if (shape.normal_maps && (take.number<std::uint8_t>() & 1) != 0)
    shape.normal_map = take_image(take);
  const storage::TilePlan plan(shape, place.format.attributes, place.format.lattice);
  if (plan.bytes() > kMostBytes)
    return {};
  std::vector<std::byte> bin(plan.bytes());
  std::copy_n(take.rest().begin(), std::min(bin.size(), take.rest().size()), bin.begin());
  Bounds bounds;
  if (!bounds_in(bin, plan, bounds))
    bounds = {{0, 0, 0}, {0, 0, 0}};
  if (!storage::row_of(place.format.compression).packs_sections || !has_vertices_below(plan, bin))
    return storage::join_glb(plan.document(bounds, place.format.frame).dump(), bin);
  const storage::PackedBin packed = storage::pack_bin(plan, bin);
  return storage::join_glb(plan.document(bounds, place.format.frame, &packed.packing).dump(),
                           packed.bin);
}

bool same_but_attributes(const PublishedTile& a, const PublishedTile& b) {
  return a.node == b.node && a.mesh.vertices.positions == b.mesh.vertices.positions &&
         a.mesh.own_count == b.mesh.own_count && a.mesh.boundary_count == b.mesh.boundary_count &&
         a.mesh.ghosts == b.mesh.ghosts && a.mesh.interior == b.mesh.interior &&
         a.mesh.border == b.mesh.border && a.parent_map == b.parent_map && a.chains == b.chains &&
         a.mesh.copies.vertices.positions == b.mesh.copies.vertices.positions &&
         a.mesh.copies.places == b.mesh.copies.places &&
         a.mesh.interior_wedges == b.mesh.interior_wedges &&
         a.mesh.border_wedges == b.mesh.border_wedges && a.shading == b.shading &&
         a.image == b.image && a.normal_map == b.normal_map;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
}

bool same_attributes(const PublishedTile& a, const PublishedTile& b) {
  return same_bits(a.mesh.vertices.attributes, b.mesh.vertices.attributes) &&
         same_bits(a.mesh.copies.vertices.attributes, b.mesh.copies.vertices.attributes);
}

void check_wedges(const TileMesh& mesh, const std::vector<TileTriangle>& triangles,
                  const std::vector<CornerWedges>& wedges) {
  const Copies& copies = mesh.copies;
  require(wedges.size() == (copies.empty() ? 0 : triangles.size()), "wedges of each triangle");
  for (std::size_t t = 0; t < wedges.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t place = raw(triangles[t][c]);
      require(wedges[t][c] <= copies.first_of(place + 1) - copies.first_of(place),
              "wedges are of their place");
    }
  }
}

void check_copies(const TileMesh& mesh) {
  const Copies& copies = mesh.copies;
  require(copies.vertices.size() == copies.size(), "a place a copy");
  require(copies.vertices.attributes.size() ==
              copies.size() * static_cast<std::size_t>(mesh.vertices.channels),
          "each copy has its attributes");
  require(std::ranges::is_sorted(copies.places), "copies ascend");
  for (std::size_t i = 0; i < copies.size(); ++i) {
    require(copies.places[i] < mesh.vertices.size(), "copies are of places");
    require(copies.vertices.positions[i] == mesh.vertices.positions[copies.places[i]],
            "copies lie at their places");
  }
  check_wedges(mesh, mesh.interior, mesh.interior_wedges);
  check_wedges(mesh, mesh.border, mesh.border_wedges);
}

/// Triangles are the mesh's with splits.
void check_shaded(const Shading& shading, const std::vector<TileTriangle>& triangles,
                  const std::vector<TileTriangle>& numbered, std::size_t vertices) {
  require(triangles.size() == (shading.split_of.empty() ? 0 : numbered.size()),
          "a shaded triangle of each");
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t number = raw(triangles[t][c]);
      require(number < vertices + shading.split_of.size(), "corners are there");
      require(
          (number < vertices ? number : shading.split_of[number - vertices]) == raw(numbered[t][c]),
          "splits are of their corners");
    }
  }
}

bool is_in_picture(const Vec2f& texcoord) {
  return texcoord.u >= 0 && texcoord.u <= 1 && texcoord.v >= 0 && texcoord.v <= 1;
}

void check_shading(const PublishedTile& tile, const Place& place) {
  const Shading& shading = tile.shading;
  const TileMesh& mesh = tile.mesh;
  const bool textured = place.format.textures && !(mesh.interior.empty() && mesh.border.empty());
  const std::size_t vertices = mesh.vertices.size() + mesh.copies.size();
  const std::size_t all = vertices + shading.split_of.size();
  require(shading.normals.size() == (place.format.computed_normals ? all : 0),
          "normals where they are computed");
  require(shading.texcoords.size() == (textured ? all : 0), "texture coordinates of textured ones");
  require(std::ranges::all_of(shading.texcoords, is_in_picture), "within the picture");
  require(tile.image.empty() != textured && tile.image.bytes.empty() != textured, "a picture");
  if (shading.empty())
    return;
  const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places);
  require(std::ranges::is_sorted(shading.split_of), "splits ascend");
  check_shaded(shading, shading.interior, numbers.numbered(mesh.interior, mesh.interior_wedges),
               vertices);
  check_shaded(shading, shading.border, numbers.numbered(mesh.border, mesh.border_wedges),
               vertices);
}

void check_triangles(const TileMesh& mesh) {
  for (const auto* triangles : {&mesh.interior, &mesh.border}) {
    for (const TileTriangle& t : *triangles) {
      std::size_t own = 0;
      for (const TileVertex corner : t) {
        require(raw(corner) < mesh.vertices.size(), "corners are vertices");
        own += mesh.is_own(corner) ? 1 : 0;
      }
      require((own == 3) == (triangles == &mesh.interior) && own > 0, "corners are where they may");
    }
    require(std::is_sorted(triangles->begin(), triangles->end()), "triangles ascend");
  }
}

bool are_tile_vertices(std::span<const std::uint16_t> vertices) {
  return std::all_of(vertices.begin(), vertices.end(),
                     [](std::uint16_t v) { return v < storage::kMaxOwnVertices; });
}

void check_tile(const PublishedTile& tile, const Place& place) {
  const TileMesh& mesh = tile.mesh;
  require(mesh.own_count >= 1 && mesh.own_count <= storage::kMaxOwnVertices, "own vertices");
  require(mesh.boundary_count <= mesh.own_count, "the boundary is of the own");
  require(mesh.vertices.size() == mesh.own_count + mesh.ghosts.size(), "own, then ghosts");
  require(mesh.vertices.attributes.size() ==
              mesh.vertices.size() * static_cast<std::size_t>(mesh.vertices.channels),
          "each vertex has its attributes");
  require(are_tile_vertices(tile.parent_map), "parents are tiles' vertices");
  require(tile.parent_map.size() == (tile.node == NodeId{} ? 0 : mesh.own_count), "a parent map");
  const auto unsorted =
      std::adjacent_find(mesh.ghosts.begin(), mesh.ghosts.end(), std::greater_equal{});
  require(unsorted == mesh.ghosts.end(), "ghosts ascend, each once");
  require(tile.chains.size() == mesh.ghosts.size(), "a chain a ghost");
  for (std::size_t i = 0; i < mesh.ghosts.size(); ++i) {
    const NodeId neighbour{tile.node.level, mesh.ghosts[i].tile};
    require(place.tree.contains(neighbour) && neighbour != tile.node, "ghosts are of neighbours");
    require(tile.chains[i].size() ==
                static_cast<std::size_t>(place.tree.chain_length(tile.node, neighbour)),
            "chains have their length");
    require(tile.chains[i][0] == mesh.ghosts[i].index, "chains begin with the ghost");
    require(are_tile_vertices(tile.chains[i]), "chains are of tiles' vertices");
  }
  check_triangles(mesh);
  check_copies(mesh);
  check_shading(tile, place);
}

/// Nothing is lost but what glTF cannot say above the partitions; that goes the first time.
void check_written(const PublishedTile& tile, const Place& place) {
  const auto again = [&](const PublishedTile& from) {
    return storage::decode_tile(storage::encode_tile(from, place.tree, place.format), place.node,
                                place.tree, place.format, "again.glb");
  };
  const PublishedTile second = again(tile);
  require(same_but_attributes(second, tile), "what is written is read again");
  if (place.tree.is_partition(place.node)) {
    require(same_attributes(second, tile), "attributes of partitions are kept bit for bit");
  } else {
    require(same_attributes(again(second), second), "what glTF can say is kept");
  }
}

}  // namespace

/// Adds values of most types, and one that no float holds.
void add_values(TileFormat& format) {
  format.attributes.values = {{"quality", ValueType::f32},
                              {"object", ValueType::i32, true},
                              {"grade", ValueType::u8},
                              {"height", ValueType::i16, true},
                              {"time", ValueType::f64}};
}

void tile(Bytes input) {
  Take take(input);
  Place place = take_place(take);
  place.format.screen_colours =
      text_of(take.rest()).find(R"("version":3,)") != std::string_view::npos;
  const bool is_gzip = text_of(take.rest()).starts_with("\x1f\x8b");
  const bool is_glb = is_gzip || text_of(take.rest()).starts_with("glTF");
  constexpr std::string_view kWithValues = R"("version":5,)";
  if (is_glb ? text_of(take.rest()).find(kWithValues) != std::string_view::npos
             : place.format.attributes.texcoords && place.format.frame.origin.z > 0)
    add_values(place.format);
  std::vector<std::byte> file =
      is_glb ? std::vector(take.rest().begin(), take.rest().end()) : make_glb(take, place);
  if (!is_gzip && storage::row_of(place.format.compression).pack_file != nullptr)
    file = storage::gzip(file);
  PublishedTile read;
  const std::string refused = refusal({ErrorCode::corrupt}, "tile.glb: ", [&] {
    read = storage::decode_tile(file, place.node, place.tree, place.format, "tile.glb");
  });
  if (!refused.empty())
    return;
  check_tile(read, place);
  check_written(read, place);
}

}  // namespace meshhier::tests::fuzz
