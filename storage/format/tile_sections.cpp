#include "storage/format/tile_sections.h"

#include "hierarchy/value_channels.h"
#include "storage/format/section_triangles.h"
#include "storage/format/tile_glb.h"
#include "storage/format/tile_values.h"

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

class Reader : SectionReader {
 public:
  using SectionReader::SectionReader;

  std::vector<Vec3f> positions() const {
    const Section& section = plan_[TilePart::position];
    std::vector<Vec3f> positions(plan_.shape().vertices());
    for (std::size_t v = 0; v < positions.size(); ++v) {
      positions[v] = position(section, v);
      if (!is_finite(positions[v]))
        fail(fmt::format("position of vertex {} is not finite", v));
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
    tile.objects = objects(mesh.vertices);
    mesh.own_count = static_cast<std::uint32_t>(shape.own);
    mesh.boundary_count = static_cast<std::uint32_t>(shape.boundary);
    mesh.copies = take_copies(mesh.vertices, copy_places(mesh.vertices.positions));
    Shading& shading = tile.shading;
    shading.normals = normals();
    shading.tangents = tangents();
    shading.texcoords = plan_.shape().has_image() ? texcoords() : map_texcoords();
    shading.split_of = splits();
    check_split_features(shading.split_of);
    const VertexNumbers numbers(static_cast<std::uint32_t>(shape.places()), mesh.copies.places);
    read_triangles(*this, TilePart::interior, numbers, shading.split_of,
                   {mesh.interior, mesh.interior_wedges, shading.interior});
    read_triangles(*this, TilePart::border, numbers, shading.split_of,
                   {mesh.border, mesh.border_wedges, shading.border});
    tile.parent_map = short_list(TilePart::parent_map, "parent map");
    tile.image = image();
    tile.normal_map = normal_map();
    tile.first_view = shape.first_view;
    read_ghosts(tile);
    return tile;
  }

 private:
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
    read_values(attributes);
    return attributes;
  }

  void read_values(std::span<float> attributes) const {
    const AttributeLayout& layout = plan_.layout();
    const Section& section = plan_[TilePart::values];
    const Section& raw_section = plan_[TilePart::raw_values];
    const auto channels = static_cast<std::size_t>(layout.channels());
    std::size_t from = section.offset, raw_from = raw_section.offset;
    const std::vector<PlacedValue> placed = placed_values(layout);
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const PlacedValue& value = placed[i];
      const ScalarAttribute& attribute = layout.values[i];
      for (std::size_t v = 0; v < plan_.shape().vertices(); ++v) {
        float* to = attributes.data() + v * channels + value.channel;
        put_value(value.type,
                  value_of_stored(value.type, stored_in(attribute, from + v * section.stride, v)),
                  to);
        if (!plan_.shape().raw_values)
          continue;
        const std::byte* at = bin_.data() + raw_from + v * raw_section.stride;
        if (takes_two_channels(value.type))
          put_value(value.type, load_little<double>(at), to);
        else
          *to = load_little<float>(at);
      }
      from += kValueStride;
      raw_from += value.channels() * sizeof(float);
    }
  }

  double stored_in(const ScalarAttribute& value, std::size_t offset, std::size_t vertex) const {
    const std::byte* at = bin_.data() + offset;
    switch (component_of(value.type)) {
      case kI8:
        return static_cast<std::int8_t>(load_little<std::uint8_t>(at));
      case kU8:
        return load_little<std::uint8_t>(at);
      case kI16:
        return static_cast<std::int16_t>(load_little<std::uint16_t>(at));
      case kU16:
        return load_little<std::uint16_t>(at);
      default:
        break;
    }
    const auto stored = load_little<float>(at);
    if (!std::isfinite(stored))
      fail(fmt::format("value {} of vertex {} is not finite", value.name, vertex));
    return stored;
  }

  std::uint64_t feature(std::uint64_t vertex) const {
    const Section& section = plan_[TilePart::feature];
    if (section.component == kU16)
      return get<std::uint16_t>(section, vertex);
    const auto stored = get<float>(section, vertex);
    if (!(stored >= 0 && stored < static_cast<float>(kMostObjects)))
      fail(fmt::format("the row of vertex {} in the table of objects is {}", vertex, stored));
    return static_cast<std::uint64_t>(stored);
  }

  /// Reads the table, and checks that vertices, copies included, have the rows of their objects.
  TileObjects objects(const VertexArray& vertices) const {
    const auto& shape = plan_.shape().objects;
    if (!shape)
      return {};
    const Section& section = plan_[TilePart::objects];
    const auto table = bin_.subspan(section.offset, section.bytes());
    TileObjects objects{read_objects(table, ObjectColumns(*shape), name_),
                        shape->columns,
                        shape->text_bytes,
                        {table.begin(), table.end()}};
    const PlacedValue place = placed_object(plan_.layout()).value();
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      const std::uint64_t row = feature(v);
      const double object = place.in(vertices.attributes_of(v).data());
      if (row >= shape->rows || objects.objects[row] != object)
        fail(fmt::format("vertex {} has row {} in the table of objects, which is not of its object",
                         v, row));
    }
    return objects;
  }

  void check_split_features(std::span<const std::uint32_t> split_of) const {
    for (std::size_t i = 0; plan_.shape().objects && i < split_of.size(); ++i) {
      if (feature(plan_.shape().vertices() + i) != feature(split_of[i]))
        fail(fmt::format("split {} has another object than its vertex", i));
    }
  }

  /// Returns the vertices that the elements of a section repeat; checks that they are below `limit`
  /// and ascend.
  std::vector<std::uint32_t> repeated_vertices(TilePart part, std::uint64_t limit,
                                               const char* what) const {
    const Section& section = plan_[part];
    std::vector<std::uint32_t> vertices(section.count);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      vertices[i] = number(section, i);
      if (vertices[i] >= limit || (i > 0 && vertices[i] < vertices[i - 1])) {
        fail(fmt::format("{} {} is of vertex {}, expected one of the first {}, ascending", what, i,
                         vertices[i], limit));
      }
    }
    return vertices;
  }

  /// Returns the places of the copies. `positions`: those of all vertices.
  std::vector<std::uint32_t> copy_places(std::span<const Vec3f> positions) const {
    const std::uint64_t place_count = plan_.shape().places();
    std::vector<std::uint32_t> places = repeated_vertices(TilePart::copy_of, place_count, "copy");
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (positions[place_count + i] != positions[places[i]])
        fail(fmt::format("copy {} does not lie where its vertex {} does", i, places[i]));
    }
    return places;
  }

  /// Returns the computed normals of vertices and splits.
  std::vector<NormalCode> normals() const {
    return plan_.shape().computed_normals ? codes(TilePart::normal, "normal", is_normal_code, "0")
                                          : std::vector<NormalCode>();
  }
  /// Returns the tangents for the normal map, of vertices and splits.
  std::vector<TangentCode> tangents() const {
    return codes(TilePart::tangent, "tangent", is_tangent_code, "127 or -127");
  }
  /// Reads three numbers of a direction and a fourth, which `is_sound` checks.
  template <class Code>
  std::vector<Code> codes(TilePart part, const char* what, bool (*is_sound)(const Code&),
                          const char* fourth) const {
    const Section& section = plan_[part];
    std::vector<Code> codes(section.count);
    for (std::size_t v = 0; v < codes.size(); ++v) {
      for (std::size_t i = 0; i < 4; ++i)
        codes[v][i] = static_cast<std::int8_t>(get<std::uint8_t>(section, v, i));
      if (!is_sound(codes[v])) {
        fail(fmt::format("the {} of vertex {} is ({}, {}, {}, {}), expected unit length and {}",
                         what, v, codes[v][0], codes[v][1], codes[v][2], codes[v][3], fourth));
      }
    }
    return codes;
  }

  /// Returns the coordinates in the tile's picture, of vertices and splits.
  std::vector<Vec2f> texcoords() const {
    const Section& section = plan_[TilePart::texcoord];
    std::vector<Vec2f> texcoords(plan_.shape().has_image() ? section.count : 0);
    const auto is_inside = [](float value) { return value >= 0 && value <= 1; };
    for (std::size_t v = 0; v < texcoords.size(); ++v) {
      texcoords[v] = {get<float>(section, v, 0), get<float>(section, v, 1)};
      if (!is_inside(texcoords[v].u) || !is_inside(texcoords[v].v)) {
        fail(fmt::format("the texture coordinate of vertex {} is ({}, {}), expected 0 to 1", v,
                         texcoords[v].u, texcoords[v].v));
      }
    }
    return texcoords;
  }

  /// Returns the coordinates in the tile's normal map, of vertices and splits.
  std::vector<Vec2f> map_texcoords() const {
    const Section& section = plan_[TilePart::map_texcoord];
    std::vector<Vec2f> texcoords(section.count);
    for (std::size_t v = 0; v < texcoords.size(); ++v)
      texcoords[v] = {map_texcoord(get<std::uint16_t>(section, v, 0)),
                      map_texcoord(get<std::uint16_t>(section, v, 1))};
    return texcoords;
  }

  TileImage image() const {
    const TileShape& shape = plan_.shape();
    return shape.has_image() ? image(TilePart::image, shape.image,
                                     stored_format(*shape.textures, shape.image.alpha))
                             : TileImage{};
  }
  TileImage normal_map() const {
    const TileShape& shape = plan_.shape();
    return shape.has_normal_map()
               ? image(TilePart::normal_map, shape.normal_map, shape.normal_maps->format)
               : TileImage{};
  }
  TileImage image(TilePart part, const ImageShape& shape, ImageFormat format) const {
    const Section& section = plan_[part];
    const auto bytes = bin_.subspan(section.offset, section.bytes());
    return {format, shape.alpha, shape.width, shape.height, {bytes.begin(), bytes.end()}};
  }

  /// Returns the parts in which a split must be equal to its vertex.
  std::vector<TilePart> common_parts() const {
    std::vector<TilePart> parts{TilePart::position};
    for (const ChannelGroup& group : groups_of(plan_.layout())) {
      if (group.channels > 0)
        parts.push_back(group.part);
    }
    return parts;
  }

  /// Returns the vertex of each split; checks that all but what was computed is the same there.
  std::vector<std::uint32_t> splits() const {
    const std::uint64_t vertex_count = plan_.shape().vertices();
    const auto vertices = repeated_vertices(TilePart::split_of, vertex_count, "split");
    for (const TilePart part : common_parts()) {
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (!std::ranges::equal(element(part, vertices[i]), element(part, vertex_count + i)))
          fail(fmt::format("split {} has not the {} of its vertex {}", i, key_of(part),
                           vertices[i]));
      }
    }
    return vertices;
  }

  /// Returns the bytes of an element; none if the section is not there.
  std::span<const std::byte> element(TilePart part, std::uint64_t number) const {
    const Section& section = plan_[part];
    return section.count == 0
               ? std::span<const std::byte>()
               : bin_.subspan(section.offset + number * section.stride, section.stride);
  }

  void read_ghosts(PublishedTile& tile) const {
    const Section& neighbours = plan_[TilePart::neighbours];
    const Section& starts = plan_[TilePart::ghost_starts];
    const std::vector<std::uint16_t> chains = short_list(TilePart::ghost_chains, "ghost chain");
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

  /// Reads one attribute of all vertices. `require_finite`: for what viewers read; raw values may
  /// be anything.
  void read_group(const ChannelGroup& group, TilePart part, bool require_finite,
                  std::span<float> attributes) const {
    const Section& section = plan_[part];
    const auto channels = static_cast<std::size_t>(plan_.layout().channels());
    const std::uint64_t count = std::min(section.count, plan_.shape().vertices());
    for (std::size_t v = 0; v < count; ++v) {
      for (std::size_t c = 0; c < group.channels; ++c) {
        float& value = attributes[v * channels + group.offset + c];
        value = section.component == kU8    ? get<std::uint8_t>(section, v, c)
                : section.component == kU16 ? get<std::uint16_t>(section, v, c)
                                            : get<float>(section, v, c);
        if (require_finite && !std::isfinite(value)) {
          fail(fmt::format("{} of vertex {} is not finite", key_of(part), v));
        }
        if (part == TilePart::colour)
          value = colour(value, v, c);
      }
    }
  }

  /// Returns a colour's number as the input had it.
  float colour(float stored, std::size_t vertex, std::size_t channel) const {
    if (!colours_.is_sound(stored, channel))
      fail(fmt::format("a colour of vertex {} is {}, which no 8-bit colour becomes", vertex,
                       stored));
    return colours_.number(stored, channel);
  }

  std::vector<std::uint16_t> short_list(TilePart part, const char* what) const {
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

  TileColours colours_ = plan_.colours();
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
