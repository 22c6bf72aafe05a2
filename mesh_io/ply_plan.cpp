#include "mesh_io/ply_plan.h"

#include "hierarchy/value_channels.h"
#include "mesh_io/input_error.h"
#include "mesh_io/ply_face_plan.h"
#include "mesh_io/ply_properties.h"
#include "mesh_io/ply_value_plan.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Role = PlyElementPlan::Role;

class Planner {
 public:
  Planner(const PlyHeader& header, std::uint64_t file_bytes, const std::filesystem::path& path,
          PlyWrittenBy writer, const AttributeChoice& choice)
      : header_(header), file_bytes_(file_bytes), path_(path), writer_(writer), choice_(choice) {}

  PlyPlan plan() {
    plan_.encoding = header_.encoding;
    plan_.odd_header_lines = header_.odd_lines;
    for (const PlyElement& element : header_.elements)
      plan_.elements.push_back(measure(element));
    plan_vertices();
    plan_faces(plan_, header_.texture_files, path_);
    if (writer_ == PlyWrittenBy::anyone)
      plan_face_values(plan_, choice_, path_);
    check_range_grid();
    check_sizes();
    list_unused();
    return std::move(plan_);
  }

 private:
  /// The properties that are the channels of one kind, in order.
  struct FoundAttribute {
    AttributeKind kind{};
    std::vector<int> properties;
  };

  [[noreturn]] void fail(const std::string& message) const { fail_file(path_, message); }

  PlyElementPlan measure(const PlyElement& element) const;
  void plan_vertices();
  void plan_attributes(PlyElementPlan& vertices);
  std::vector<FoundAttribute> find_attributes(const PlyElement& vertices);
  std::optional<PlyColour> find_colours(const PlyElement& vertices);
  void take_colours(const PlyColour& colour);
  void check_range_grid() const;
  void check_sizes() const;
  void list_unused();

  bool find_all(const PlyElement& element, std::span<const std::string_view> names,
                std::span<int> found) const {
    return mesh_io::find_all(element, names, found, path_);
  }

  const PlyHeader& header_;
  std::uint64_t file_bytes_;
  const std::filesystem::path& path_;
  PlyWrittenBy writer_;
  const AttributeChoice& choice_;
  PlyPlan plan_;
};

/// Measures rows. In text the shortest row has one digit and one separator a number; a list may be
/// its length alone.
PlyElementPlan Planner::measure(const PlyElement& element) const {
  PlyElementPlan plan;
  plan.element = element;
  plan.slots.assign(element.properties.size(), kSkipped);
  const bool text = header_.encoding == PlyEncoding::ascii;
  bool fixed = !text;
  for (const PlyProperty& property : element.properties) {
    const std::uint64_t values = std::max<std::uint64_t>(property.fixed_count, 1);
    plan.min_row_bytes +=
        values * (text ? 2 : size_of(property.count_type.value_or(property.type)));
    fixed = fixed && !property.count_type;
  }
  if (fixed)
    plan.stride = plan.min_row_bytes;
  if (element.count > 0 && element.properties.empty()) {
    fail(fmt::format("expected properties of element {}, which declares {} rows, found none",
                     in_quotes(element.name), element.count));
  }
  return plan;
}

void Planner::plan_vertices() {
  const auto vertices =
      std::find_if(plan_.elements.begin(), plan_.elements.end(),
                   [](const PlyElementPlan& plan) { return plan.element.name == "vertex"; });
  if (vertices == plan_.elements.end())
    fail("expected an element 'vertex', found none");
  constexpr std::uint64_t kMaxVertices = std::numeric_limits<std::uint32_t>::max();
  const PlyElement& element = vertices->element;
  if (element.count > kMaxVertices) {
    fail(fmt::format("expected at most {} vertices, found {} declared (split the mesh)",
                     kMaxVertices, element.count));
  }
  constexpr std::array<std::string_view, 3> kNames{"x", "y", "z"};
  std::array<int, 3> found{};
  if (!find_all(element, kNames, found)) {
    fail("expected the scalar properties 'x', 'y' and 'z' of element 'vertex', not all found");
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto property = static_cast<std::size_t>(found[axis]);
    vertices->slots[property] = static_cast<int>(axis);
    const PlyType type = element.properties[property].type;
    plan_.wide_coordinates |= takes_two_channels(value_type(type));
  }
  vertices->role = Role::vertices;
  plan_.vertex_element = static_cast<std::size_t>(vertices - plan_.elements.begin());
  plan_attributes(*vertices);
}

/// Values are the chosen properties that are nothing else; where channels lie is known once all
/// attributes are.
void Planner::plan_attributes(PlyElementPlan& vertices) {
  AttributeLayout& layout = plan_.attributes;
  std::vector<FoundAttribute> found = find_attributes(vertices.element);
  std::vector<int> others;
  for (const FoundAttribute& one : found)
    others.insert(others.end(), one.properties.begin(), one.properties.end());
  const auto is_other = [&](std::size_t property) {
    return vertices.slots[property] != kSkipped ||
           std::ranges::find(others, static_cast<int>(property)) != others.end();
  };
  std::vector<std::size_t> values;
  for (std::size_t i = 0; i < vertices.slots.size(); ++i) {
    const PlyProperty& property = vertices.element.properties[i];
    if (is_other(i) || property.is_list())
      continue;
    if (const auto value = value_of(property, choice_, writer_, layout)) {
      layout.values.push_back(*value);
      values.push_back(i);
    }
  }
  const std::vector<PlacedValue> placed = placed_values(layout);
  for (std::size_t i = 0; i < values.size(); ++i)
    vertices.slots[values[i]] = kFirstAttributeSlot + static_cast<int>(placed[i].channel);
  for (const auto& [kind, properties] : found) {
    int slot = kFirstAttributeSlot + static_cast<int>(layout.part(kind).first);
    for (const int property : properties)
      vertices.slots[static_cast<std::size_t>(property)] = slot++;
  }
}

/// All but values; puts them into the layout.
std::vector<Planner::FoundAttribute> Planner::find_attributes(const PlyElement& vertices) {
  AttributeLayout& layout = plan_.attributes;
  std::vector<FoundAttribute> found;
  if (std::optional<PlyColour> colour = find_colours(vertices))
    found.push_back({AttributeKind::colours, std::move(colour->properties)});
  for (const PlyAttribute& attribute : kPlyAttributes) {
    const bool is_asked = !attribute.is_of_import || writer_ == PlyWrittenBy::import;
    const bool needs_texcoords = attribute.kind == AttributeKind::material;
    if (!is_asked || (needs_texcoords && !layout.texcoords))
      continue;
    std::vector<int> properties = find_attribute(vertices, attribute, path_);
    layout.*row_of(attribute.kind).flag = !properties.empty();
    found.push_back({attribute.kind, std::move(properties)});
  }
  return found;
}

std::optional<PlyColour> Planner::find_colours(const PlyElement& vertices) {
  for (const PlyColourNames& names : kPlyColours) {
    if (auto found = find_colour(vertices, names, path_)) {
      take_colours(*found);
      return found;
    }
  }
  if (writer_ != PlyWrittenBy::import)
    return std::nullopt;
  for (const ColourSpace space : {ColourSpace::srgb, ColourSpace::linear}) {
    for (const bool tints : {false, true}) {
      const auto [red, green, blue] = imported_colour_names(space, tints);
      auto found = find_colour(vertices, {red, green, blue, "alpha", "a"}, path_);
      if (!found)
        continue;
      take_colours(*found);
      plan_.attributes.space = space;
      plan_.attributes.tints = tints;
      return found;
    }
  }
  return std::nullopt;
}

void Planner::take_colours(const PlyColour& colour) {
  plan_.attributes.colour = colour.kind;
  plan_.attributes.alpha = colour.properties.size() == 4;
  plan_.checks.colours = colour.is_checked;
}

/// A raw scan's grid is no list of faces, and to take such a file for a cloud of points would lose
/// what its owner sees in it.
void Planner::check_range_grid() const {
  bool grid = false;
  for (const PlyElementPlan& plan : plan_.elements) {
    if (plan.has_faces())
      return;
    grid = grid || (plan.element.name == "range_grid" && plan.element.count > 0);
  }
  if (grid) {
    fail(
        "expected faces, found a range grid (element 'range_grid'): this is a raw range scan, not a"
        " mesh; triangulate it first");
  }
}

void Planner::check_sizes() const {
  std::uint64_t offset = header_.data_offset;
  for (std::size_t i = 0; i < plan_.elements.size(); ++i) {
    const PlyElementPlan& plan = plan_.elements[i];
    // The last number of a text may end with the file.
    const bool open_end = header_.encoding == PlyEncoding::ascii;
    const std::uint64_t left = file_bytes_ - offset + (open_end ? 1 : 0);
    const std::uint64_t row = plan.min_row_bytes;
    if (row > 0 && plan.element.count > left / row) {
      fail_at_byte(
          path_, file_bytes_,
          fmt::format("expected {} rows of element {} with at least {} bytes each, found "
                      "the end of the file {} bytes after they can begin at the earliest "
                      "(truncated, or the count in the header is wrong)",
                      plan.element.count, in_quotes(plan.element.name), row, file_bytes_ - offset));
    }
    offset = std::min(offset + plan.element.count * row, file_bytes_);
  }
}

void Planner::list_unused() {
  for (const PlyElementPlan& plan : plan_.elements) {
    if (plan.element.count == 0 || plan.role == Role::texture_vertices)
      continue;  // whose number of a picture is that of their faces
    if (plan.role == Role::skipped) {
      plan_.unused.push_back(plan.element.name);
      continue;
    }
    for (std::size_t i = 0; i < plan.element.properties.size(); ++i) {
      if (!plan.takes(i))
        plan_.unused.push_back(plan.element.name + '.' + plan.element.properties[i].name);
    }
  }
}

}  // namespace

std::string imported_prefix(ValueKind kind) {
  return std::string(name_in(kValueKinds, kind)) + ':';
}

std::array<std::string_view, 3> imported_colour_names(ColourSpace space, bool tints) {
  if (space == ColourSpace::srgb) {
    return tints ? std::array<std::string_view, 3>{"tint_red", "tint_green", "tint_blue"}
                 : std::array<std::string_view, 3>{"red", "green", "blue"};
  }
  return tints ? std::array<std::string_view, 3>{"linear_tint_red", "linear_tint_green",
                                                 "linear_tint_blue"}
               : std::array<std::string_view, 3>{"linear_red", "linear_green", "linear_blue"};
}

bool PlyElementPlan::takes(std::size_t property) const {
  switch (role) {
    case Role::texture_vertices:
      return property == texcoord[0] || property == texcoord[1];
    case Role::polygons:
    case Role::texture_faces:
      return property == corners || property == texcoords || property == texnumber ||
             property == face || std::ranges::find(colour, property) != colour.end() ||
             std::ranges::find(values, property) != values.end();
    case Role::strips:
      return property == corners;
    case Role::vertices:
      return slots[property] != kSkipped;
    case Role::skipped:
      break;
  }
  return false;
}

PlyPlan make_ply_plan(const PlyHeader& header, std::uint64_t file_bytes,
                      const std::filesystem::path& path, PlyWrittenBy writer,
                      const AttributeChoice& attributes) {
  return Planner(header, file_bytes, path, writer, attributes).plan();
}

}  // namespace meshhier::mesh_io
