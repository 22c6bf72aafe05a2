#include "export/cut_by_error.h"
#include "export/cut_part.h"
#include "hierarchy/attributes.h"
#include "hierarchy/value_channels.h"
#include "library/errors.h"
#include "storage/format/archive_files.h"
#include "storage/format/glb_material.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/io/file.h"

#include <algorithm>
#include <utility>

namespace meshhier::v1 {
namespace {

Point point(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

NodeId inner(Node node) {
  return {Level(static_cast<int>(node.level)), node.index};
}
Node outer(NodeId node) {
  return {static_cast<std::uint32_t>(raw(node.level)), node.index};
}

TileFacts facts_of(const TileRecord& record, const Vec3d& origin) {
  TileFacts facts;
  facts.node = outer(record.node);
  facts.error = record.error;
  facts.bound = record.bound;
  facts.low = point(to_double(record.bounds.min) + origin);
  facts.high = point(to_double(record.bounds.max) + origin);
  facts.vertices = record.own_count;
  facts.triangles = record.interior_count + record.border_count;
  facts.file_bytes = record.file_bytes;
  return facts;
}

}  // namespace

std::string version() {
  return MESHHIER_VERSION;
}

Error::Error(Failure failure, const std::string& message)
    : std::runtime_error(message), failure_(failure) {}

struct Hierarchy::Parts {
  explicit Parts(const std::string& path)
      : files(storage::make_posix_file_system()), place(*files, path), reader(place.files(), path) {
    const storage::Manifest& manifest = reader.manifest();
    for (const TileRecord& record : reader.records())
      tiles.push_back(facts_of(record, manifest.origin));
    for (const ScalarAttribute& value : manifest.source.attributes.values)
      attributes.push_back({value.name, std::string(name_of(value.type)), value.is_label});
  }

  const SourceSummary& source() const { return reader.manifest().source; }

  std::unique_ptr<storage::FileSystem> files;
  storage::HierarchyFiles place;
  storage::HierarchyReader reader;
  std::vector<TileFacts> tiles;
  std::vector<AttributeFacts> attributes;
};

struct Cut::Parts {
  std::shared_ptr<const Hierarchy::Parts> hierarchy;
  exporting::CutParts parts;
};

Hierarchy::Hierarchy(const std::string& path)
    : parts_(translated([&] { return std::make_shared<const Parts>(path); })) {}

std::uint32_t Hierarchy::levels() const {
  return static_cast<std::uint32_t>(raw(parts_->reader.tree().depth())) + 1;
}
std::uint64_t Hierarchy::vertices() const {
  return parts_->source().vertices;
}
std::uint64_t Hierarchy::triangles() const {
  return parts_->source().triangles;
}
Point Hierarchy::low() const {
  return point(parts_->source().bounds.min);
}
Point Hierarchy::high() const {
  return point(parts_->source().bounds.max);
}
Point Hierarchy::origin() const {
  return point(parts_->reader.manifest().origin);
}
bool Hierarchy::is_z_up() const {
  return parts_->reader.manifest().up == UpAxis::z;
}
bool Hierarchy::is_textured() const {
  return parts_->source().textures.has_value();
}
bool Hierarchy::colours_are_linear() const {
  return parts_->source().attributes.space == ColourSpace::linear;
}
const std::vector<AttributeFacts>& Hierarchy::attributes() const {
  return parts_->attributes;
}
const std::vector<TileFacts>& Hierarchy::tiles() const {
  return parts_->tiles;
}

const TileFacts& Hierarchy::tile(Node node) const {
  const auto found =
      std::lower_bound(parts_->tiles.begin(), parts_->tiles.end(), node,
                       [](const TileFacts& tile, Node wanted) { return tile.node < wanted; });
  if (found == parts_->tiles.end() || !(found->node == node)) {
    throw Error(Failure::usage, "there is no tile " + std::to_string(node.level) + '/' +
                                    std::to_string(node.index));
  }
  return *found;
}

std::vector<Node> Hierarchy::children(Node node) const {
  return translated([&] {
    tile(node);
    const Tree& tree = parts_->reader.tree();
    std::vector<Node> below;
    const Tree::Children children = tree.children(inner(node));
    for (const NodeId child : children.span())
      below.push_back(outer(tree.tile_node(child)));
    return below;
  });
}

namespace {

std::vector<Node> nodes_of(const meshhier::Cut& cut) {
  std::vector<Node> nodes;
  for (const NodeId node : cut.nodes())
    nodes.push_back(outer(node));
  return nodes;
}

}  // namespace

std::vector<Node> Hierarchy::level(std::uint32_t level) const {
  return translated([&] {
    const Tree& tree = parts_->reader.tree();
    const auto wanted = Level(static_cast<int>(std::min(level, std::uint32_t{1} << 20)));
    require_level(tree, wanted);
    return nodes_of(meshhier::Cut::of_level(tree, wanted));
  });
}

std::vector<Node> Hierarchy::within(double error) const {
  return translated([&] { return nodes_of(exporting::cut_by_error(parts_->reader, {error})); });
}

Cut Hierarchy::cut(const std::vector<Node>& nodes, std::uint64_t cache_bytes) const {
  return translated([&] {
    std::vector<NodeId> inners;
    for (const Node node : nodes)
      inners.push_back(inner(tile(node).node));
    meshhier::Cut cut(parts_->reader.tree(), std::move(inners));
    return Cut(std::make_shared<Cut::Parts>(
        Cut::Parts{parts_, exporting::CutParts(parts_->reader, std::move(cut), cache_bytes)}));
  });
}

std::size_t Cut::size() const {
  return parts_->parts.size();
}

Node Cut::node(std::size_t position) const {
  return outer(parts_->parts.cut()[position]);
}

namespace {

void take_attributes(const AttributeLayout& layout, const VertexArray& vertices, Part& part) {
  const float full = full_number(layout.colour);
  const AttributePart normal = layout.part(AttributeKind::normals);
  const AttributePart colour = layout.part(AttributeKind::colours);
  const AttributePart texcoord = layout.part(AttributeKind::texcoords);
  const std::vector<PlacedValue> values = placed_values(layout);
  part.values.resize(values.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const std::span<const float> all = vertices.attributes_of(v);
    if (normal.count > 0)
      part.normals.push_back({all[normal.first], all[normal.first + 1], all[normal.first + 2]});
    if (colour.count > 0) {
      const std::span<const float> c = colour.of(all);
      part.colours.push_back(
          {c[0] / full, c[1] / full, c[2] / full, layout.alpha ? c[3] / full : 1});
    }
    if (texcoord.count > 0)
      part.texcoords.push_back({all[texcoord.first], all[texcoord.first + 1]});
    for (std::size_t i = 0; i < values.size(); ++i)
      part.values[i].push_back(values[i].in(all.data()));
  }
}

}  // namespace

Part Cut::load(std::size_t position) {
  return translated([&] {
    if (position >= size())
      throw Error(Failure::usage, "the cut has " + std::to_string(size()) + " parts");
    const storage::HierarchyReader& reader = parts_->hierarchy->reader;
    exporting::CutPart loaded = parts_->parts.load(position);
    Part part;
    part.node = node(position);
    for (const Vec3f& p : loaded.vertices.positions)
      part.positions.push_back(point(to_double(p) + reader.manifest().origin));
    take_attributes(reader.tile_format().attributes, loaded.vertices, part);
    for (const Vec3f& n : loaded.normals)
      part.normals.push_back({n.x, n.y, n.z});
    for (const Vec2f& t : loaded.texcoords)
      part.texcoords.push_back({t.u, t.v});
    part.places = std::move(loaded.places);
    part.triangles.assign(loaded.triangles.begin(), loaded.triangles.end());
    if (!loaded.image.empty()) {
      part.image_type = row_of(loaded.image.format).file.media_type;
      part.image = std::move(loaded.image.bytes);
    }
    return part;
  });
}

}  // namespace meshhier::v1
