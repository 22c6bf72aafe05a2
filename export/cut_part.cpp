#include "export/cut_part.h"

#include "export/nearest_vertex.h"
#include "export/tile_vertices.h"
#include "hierarchy/shown_corners.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>

namespace meshhier::exporting {
namespace {

/// The place where the cut shows a tile's place.
struct ShownPlace {
  std::uint32_t number = 0;                      ///< number in the cut
  std::shared_ptr<const PublishedTile> other{};  ///< null: as the tile has it
  std::uint32_t place = 0;                       ///< the place's number in `other`
};

using FindPlace = std::function<ShownPlace(std::uint32_t place)>;

Vec3f unit_normal(const NormalCode& code) {
  const Vec3d wide = to_double(meshhier::normal_of(code));
  return to_float(wide * (1 / length(wide)));
}

class PartMaker {
 public:
  PartMaker(const PublishedTile& tile, const AttributeRules& rules, const FindPlace& find)
      : tile_(tile), rules_(rules), find_(find), numbers_(vertex_numbers(tile.mesh)) {
    part_.vertices.channels = tile.mesh.vertices.channels;
  }

  /// `triangles`: numbers of vertices and splits.
  CutPart make(const std::vector<TileTriangle>& triangles) {
    std::vector<std::uint32_t> used;
    for (const TileTriangle& t : triangles)
      used.insert(used.end(), {raw(t[0]), raw(t[1]), raw(t[2])});
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const std::uint32_t number : used)
      add(number);
    const auto place_of = [&](TileVertex v) {
      const auto found = std::lower_bound(used.begin(), used.end(), raw(v));
      return static_cast<std::uint32_t>(found - used.begin());
    };
    for (const TileTriangle& t : triangles)
      part_.triangles.push_back({place_of(t[0]), place_of(t[1]), place_of(t[2])});
    return std::move(part_);
  }

 private:
  void add(std::uint32_t number) {
    const TileMesh& mesh = tile_.mesh;
    const std::size_t vertices = mesh.vertices.size() + mesh.copies.size();
    const std::uint32_t vertex =
        number < vertices ? number : tile_.shading.split_of[number - vertices];
    const ShownPlace shown = find_(numbers_[vertex].place);
    part_.places.push_back(shown.number);
    if (!tile_.image.empty())
      part_.texcoords.push_back(tile_.shading.texcoords[number]);
    if (shown.other) {
      add_moved(at(mesh, vertex), shown);
    } else {
      add_vertex(at(mesh, vertex));
      add_normal(tile_.shading, number);
    }
  }

  static VertexAt at(const TileMesh& mesh, std::size_t vertex) {
    const std::size_t places = mesh.vertices.size();
    return vertex < places ? VertexAt{mesh.vertices, vertex}
                           : VertexAt{mesh.copies.vertices, vertex - places};
  }

  void add_vertex(const VertexAt& vertex) {
    part_.vertices.append(vertex.position(), vertex.attributes());
  }

  void add_normal(const Shading& shading, std::size_t number) {
    if (!shading.normals.empty())
      part_.normals.push_back(unit_normal(shading.normals[number]));
  }

  void add_moved(const VertexAt& vertex, const ShownPlace& shown) {
    const TileMesh& mesh = shown.other->mesh;
    const auto all = vertices_at(mesh.vertices, mesh.copies, shown.place);
    const std::size_t wedge = nearest_vertex(rules_, vertex, all);
    add_vertex(all[wedge]);
    const AttributePart& texcoords = rules_.part(AttributeKind::texcoords);
    std::ranges::copy(texcoords.of(vertex.attributes()),
                      part_.vertices.attributes.end() -
                          static_cast<std::ptrdiff_t>(rules_.channels() - texcoords.first));
    keep_object(vertex);
    add_normal(shown.other->shading,
               wedge == 0 ? shown.place
                          : mesh.vertices.size() + mesh.copies.first_of(shown.place) + wedge - 1);
  }

  /// A triangle's corners have one object, also where the neighbour shows it no more.
  void keep_object(const VertexAt& vertex) {
    for (const PlacedValue& value : rules_.values().values()) {
      if (value.is_object) {
        std::ranges::copy(vertex.attributes().subspan(value.channel, value.channels()),
                          part_.vertices.attributes.end() -
                              static_cast<std::ptrdiff_t>(rules_.channels() - value.channel));
      }
    }
  }

  const PublishedTile& tile_;
  const AttributeRules& rules_;
  const FindPlace& find_;
  VertexNumbers numbers_;
  CutPart part_;
};

CutPart make_part(PublishedTile& tile, const AttributeRules& rules,
                  const std::vector<TileTriangle>& triangles, const FindPlace& find) {
  CutPart part = PartMaker(tile, rules, find).make(triangles);
  if (!triangles.empty())
    part.image = std::move(tile.image);
  return part;
}

}  // namespace

CutPart part_of_tile(PublishedTile tile) {
  std::vector<TileTriangle> triangles = shown_interior(tile);
  const std::vector<TileTriangle> border = shown_border(tile);
  triangles.insert(triangles.end(), border.begin(), border.end());
  return make_part(tile, {}, triangles, [](std::uint32_t place) { return ShownPlace{place}; });
}

CutParts::CutParts(const storage::HierarchyReader& reader, Cut cut, std::uint64_t cache_bytes)
    : reader_(reader),
      numbered_(number_vertices(reader, std::move(cut))),
      neighbours_(
          cache_bytes,
          [&reader](NodeId node) {
            PublishedTile tile = reader.read_tile(node);
            tile.image = {};
            return tile;
          },
          [](const PublishedTile& tile) { return memory_bytes(tile); }) {}

bool CutParts::is_at_border(std::size_t position, std::uint32_t place) const {
  const TileRecord& record = reader_.record(numbered_.cut[position]);
  const std::uint32_t base = numbered_.base(position);
  return place < base || place - base >= record.own_count || place - base < record.boundary_count;
}

CutPart CutParts::load(std::size_t position) {
  PublishedTile tile = reader_.read_tile(numbered_.cut[position]);
  const std::uint32_t base = numbered_.base(position);
  const TileMesh& mesh = tile.mesh;
  std::vector<TileTriangle> triangles = shown_interior(tile);
  const std::vector<TileTriangle> border = shown_border(tile);
  for (const std::uint32_t i : draw_tile(reader_.tree(), numbered_, position, tile).border)
    triangles.push_back(border[i]);
  return make_part(tile, reader_.tile_format().attributes, triangles, [&](std::uint32_t place) {
    if (place < mesh.own_count)
      return ShownPlace{base + place};
    // A triangle that is drawn has no ghost that is shown finer.
    const ShownGhost ghost = *find_ghost(reader_.tree(), numbered_, tile, place - mesh.own_count);
    if (ghost.level == tile.node.level)
      return ShownPlace{ghost.number};
    return ShownPlace{ghost.number, neighbours_.get(numbered_.cut[ghost.position]),
                      ghost.number - numbered_.base(ghost.position)};
  });
}

}  // namespace meshhier::exporting
