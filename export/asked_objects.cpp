#include "export/asked_objects.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "config/suggest.h"
#include "export/object_condition.h"
#include "export/tile_vertices.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace meshhier::exporting {
namespace {

using storage::ObjectTable;

constexpr std::size_t kShownObjectBytes = 100;
/// So many names around the place of one that is not there may be what was meant.
constexpr std::uint32_t kNearNames = 1000;

std::string similar_name(const ObjectTable& table, const std::string& name) {
  // The names with the same first half, or letters, are neighbours.
  ObjectTable::Range range{};
  for (std::size_t bytes = name.size(); range.begin == range.end && bytes > 0; bytes /= 2)
    range = table.range_of_prefix(std::string_view(name).substr(0, bytes / 2));
  std::vector<std::string> near;
  for (std::uint32_t i = range.begin; i < std::min(range.end, range.begin + kNearNames); ++i)
    near.push_back(table.row(i).name);
  const auto found = config::nearest_word(name, near);
  return found ? fmt::format("; did you mean \"{}\"?", plain_text(*found, kShownObjectBytes)) : "";
}

ObjectTable::Range range_named(const ObjectTable& table, const std::string& name) {
  if (name.ends_with('/')) {
    const ObjectTable::Range branch = table.range_of_prefix(name);
    if (branch.begin < branch.end)
      return branch;
    throw Error(ErrorCode::usage,
                fmt::format("there is no object whose name begins with \"{}\"{}",
                            plain_text(name, kShownObjectBytes), similar_name(table, name)));
  }
  if (const auto object = table.find(name))
    return {*object, *object + 1};
  const auto [begin, end] = table.range_of_prefix(name + '/');
  const bool is_branch = begin < end;
  throw Error(ErrorCode::usage,
              fmt::format("there is no object \"{}\"{}", plain_text(name, kShownObjectBytes),
                          is_branch ? "; with a \"/\" behind it, it is a branch of their names"
                                    : similar_name(table, name)));
}

/// Returns the objects of these names, each once, ascending.
std::vector<ObjectTable::Range> ranges_named(const ObjectTable& table,
                                             const std::vector<std::string>& names) {
  std::vector<ObjectTable::Range> ranges;
  for (const std::string& name : names)
    ranges.push_back(range_named(table, name));
  std::ranges::sort(ranges, {}, &ObjectTable::Range::begin);
  std::uint32_t end = 0;
  for (ObjectTable::Range& range : ranges) {
    range.begin = std::max(range.begin, end);
    end = range.end = std::max(range.end, end);
  }
  return ranges;
}

ObjectCondition condition_of(const std::string& where, const ObjectTable& table) {
  try {
    return {where, table.properties()};
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("--where: {}", error.what()));
  }
}

BoundsD grown(const BoundsD& box, double margin) {
  const Vec3d more{margin, margin, margin};
  return {box.min - more, box.max + more};
}

bool do_meet(const BoundsD& a, const BoundsD& b) {
  return !a.empty() && !b.empty() && a.min.x <= b.max.x && b.min.x <= a.max.x &&
         a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z && b.min.z <= a.max.z;
}

/// Returns the place of a node among all of a tree.
std::size_t place_of(NodeId node) {
  return (std::size_t{1} << raw(node.level)) - 1 + node.index;
}

/// Returns how far a vertex of a tile may be from its place in the table's boxes.
double largest_shift(const storage::Manifest& manifest) {
  const double rounding = manifest.quantization ? manifest.quantization->worst_rounding : 0;
  const BoundsD& box = manifest.source.bounds;
  double most = 0;
  for (const Vec3d p : {box.min, box.max})
    most = std::max({most, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  constexpr double kRelative = 0x1p-50;
  return rounding + (box.empty() ? 0 : most * kRelative);
}

}  // namespace

void for_each_asked(const ObjectTable& table, const ObjectRequest& request,
                    const execution::CancelToken& cancel,
                    const std::function<void(std::uint32_t, const ObjectRow&)>& visit) {
  std::optional<ObjectCondition> condition;
  if (!request.where.empty())
    condition = condition_of(request.where, table);
  const auto visit_if_met = [&](std::uint32_t object, const ObjectRow& row) {
    cancel.check();
    if (!condition || condition->is_met_by(row))
      visit(object, row);
  };
  if (request.numbers) {
    for (const std::uint32_t object : *request.numbers)
      visit_if_met(object, table.row(object));
    return;
  }
  if (request.names.empty() && request.prefix.empty())
    return table.for_each(visit_if_met);
  const auto ranges = request.names.empty() ? std::vector{table.range_of_prefix(request.prefix)}
                                            : ranges_named(table, request.names);
  for (const auto& [begin, end] : ranges) {
    for (std::uint32_t object = begin; object < end; ++object)
      visit_if_met(object, table.row(object));
  }
}

AskedObjects::AskedObjects(const storage::HierarchyReader& reader, const ObjectRequest& request,
                           const execution::CancelToken& cancel)
    : tree_(reader.tree()) {
  const auto table = reader.open_objects();
  place_ = placed_object(reader.tile_format().attributes).value();
  asked_.resize(table->size());
  const std::vector<BoundsD> boxes = boxes_below(reader);
  marks_.resize(boxes.size());
  const Vec3d origin = reader.manifest().origin;
  bool is_any = false;
  for_each_asked(*table, request, cancel, [&](std::uint32_t object, const ObjectRow& row) {
    is_any = asked_[object] = true;
    if (!row.box)
      return;
    const BoundsD box{row.box->min - origin, row.box->max - origin};
    box_.add(box);
    mark({}, box, boxes);
  });
  if (!is_any)
    throw Error(ErrorCode::usage, "no object meets the condition of --where");
}

/// Returns for each node the box around the partitions below it.
std::vector<BoundsD> AskedObjects::boxes_below(const storage::HierarchyReader& reader) const {
  const double shift = largest_shift(reader.manifest());
  std::vector<BoundsD> boxes(place_of({tree_.depth(), 0}) + tree_.node_count(tree_.depth()));
  for (std::uint32_t i = 0; i < tree_.node_count(tree_.depth()); ++i) {
    const NodeId node{tree_.depth(), i};
    const Bounds& box = reader.record(node).bounds;
    if (!box.empty())
      boxes[place_of(node)] = grown({to_double(box.min), to_double(box.max)}, shift);
  }
  for (int level = raw(tree_.depth()) - 1; level >= 0; --level) {
    for (std::uint32_t i = 0; i < tree_.node_count(static_cast<Level>(level)); ++i) {
      const NodeId node{static_cast<Level>(level), i};
      const Tree::Children children = tree_.children(node);
      for (const NodeId child : children.span())
        boxes[place_of(node)].add(boxes[place_of(child)]);
    }
  }
  return boxes;
}

void AskedObjects::mark(NodeId node, const BoundsD& box, const std::vector<BoundsD>& boxes) {
  Mark& here = marks_[place_of(node)];
  if (here == Mark::all || !do_meet(boxes[place_of(node)], box))
    return;
  const Tree::Children children = tree_.children(node);
  bool are_all = true, is_any = children.count == 0;
  for (const NodeId child : children.span()) {
    mark(child, box, boxes);
    are_all = are_all && marks_[place_of(child)] == Mark::all;
    is_any = is_any || marks_[place_of(child)] != Mark::none;
  }
  here = are_all ? Mark::all : is_any ? Mark::some : Mark::none;
}

bool AskedObjects::may_show(NodeId node) const {
  return marks_[place_of(node)] != Mark::none;
}

void keep_objects(const AskedObjects& asked, PublishedTile& tile,
                  std::vector<std::uint32_t>& border) {
  TileMesh& mesh = tile.mesh;
  const VertexNumbers numbers = vertex_numbers(mesh);
  const auto is_asked = [&](const TileTriangle& triangle) {
    const std::size_t vertex = raw(triangle[0]), places = mesh.vertices.size();
    return asked.has(vertex < places ? mesh.vertices.attributes_of(vertex)
                                     : mesh.copies.vertices.attributes_of(vertex - places));
  };
  const auto borders = numbers.numbered(mesh.border, mesh.border_wedges);
  std::erase_if(border, [&](std::uint32_t i) { return !is_asked(borders[i]); });
  const auto all = numbers.numbered(mesh.interior, mesh.interior_wedges);
  const auto keep = [&](auto& list) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (is_asked(all[i]))
        list[kept++] = list[i];
    }
    list.resize(kept);
  };
  keep(mesh.interior);
  keep(mesh.interior_wedges);
  keep(tile.shading.interior);
}

}  // namespace meshhier::exporting
