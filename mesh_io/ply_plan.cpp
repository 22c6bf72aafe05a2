#include "mesh_io/ply_plan.h"

#include "mesh_io/input_error.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <string_view>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Role = PlyElementPlan::Role;

class Planner {
 public:
  Planner(const PlyHeader& header, std::uint64_t file_bytes, const std::filesystem::path& path,
          PlyWrittenBy writer)
      : header_(header), file_bytes_(file_bytes), path_(path), writer_(writer) {}

  PlyPlan plan() {
    plan_.encoding = header_.encoding;
    for (const PlyElement& element : header_.elements)
      plan_.elements.push_back(measure(element));
    plan_vertices();
    for (PlyElementPlan& element : plan_.elements)
      plan_faces(element);
    plan_textures();
    check_range_grid();
    check_sizes();
    return std::move(plan_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { fail_file(path_, message); }

  PlyElementPlan measure(const PlyElement& element) const;
  void plan_vertices();
  void plan_attributes(PlyElementPlan& vertices);
  void plan_colours(PlyElementPlan& vertices);
  void plan_materials(PlyElementPlan& vertices);
  void plan_faces(PlyElementPlan& plan) const;
  void plan_textures();
  void plan_face_textures(PlyElementPlan& plan) const;
  void check_range_grid() const;
  void check_sizes() const;

  /// Index of the scalar property `name`, or -1; fails if there are two.
  int find_scalar(const PlyElement& element, std::string_view name) const;
  /// True if all `names` are there; fills `found` with their indices.
  bool find_all(const PlyElement& element, std::span<const std::string_view> names,
                std::span<int> found) const;

  const PlyHeader& header_;
  std::uint64_t file_bytes_;
  const std::filesystem::path& path_;
  PlyWrittenBy writer_;
  PlyPlan plan_;
};

/// In text the shortest row has one digit and one separator a number; a list may be its length
/// alone.
PlyElementPlan Planner::measure(const PlyElement& element) const {
  PlyElementPlan plan;
  plan.element = element;
  plan.slots.assign(element.properties.size(), kSkipped);
  const bool text = header_.encoding == PlyEncoding::ascii;
  bool fixed = !text;
  for (const PlyProperty& property : element.properties) {
    plan.min_row_bytes += text ? 2 : size_of(property.count_type.value_or(property.type));
    fixed = fixed && !property.is_list();
  }
  if (fixed)
    plan.stride = plan.min_row_bytes;
  if (element.count > 0 && element.properties.empty()) {
    fail(fmt::format("expected properties of element {}, which declares {} rows, found none",
                     in_quotes(element.name), element.count));
  }
  return plan;
}

int Planner::find_scalar(const PlyElement& element, std::string_view name) const {
  int found = -1;
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (property.is_list() || property.name != name)
      continue;
    if (found >= 0) {
      fail(fmt::format("expected property {} of element {} once, found it twice", in_quotes(name),
                       in_quotes(element.name)));
    }
    found = static_cast<int>(i);
  }
  return found;
}

bool Planner::find_all(const PlyElement& element, std::span<const std::string_view> names,
                       std::span<int> found) const {
  for (std::size_t i = 0; i < names.size(); ++i)
    found[i] = find_scalar(element, names[i]);
  return std::all_of(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(names.size()),
                     [](int property) { return property >= 0; });
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
    plan_.wide_coordinates |= type == PlyType::f64 || type == PlyType::i32 || type == PlyType::u32;
  }
  vertices->role = Role::vertices;
  plan_.vertex_element = static_cast<std::size_t>(vertices - plan_.elements.begin());
  plan_attributes(*vertices);
}

void assign_slots(PlyElementPlan& vertices, std::span<const int> properties, int channel) {
  for (const int property : properties) {
    vertices.slots[static_cast<std::size_t>(property)] = kFirstAttributeSlot + channel++;
  }
}

void Planner::plan_attributes(PlyElementPlan& vertices) {
  AttributeLayout& layout = plan_.attributes;
  std::array<int, 3> found{};
  constexpr std::array<std::string_view, 3> kNormals{"nx", "ny", "nz"};
  if (find_all(vertices.element, kNormals, found)) {
    layout.normals = true;
    assign_slots(vertices, found, layout.normal_offset());
  }
  plan_colours(vertices);
  constexpr std::array<std::array<std::string_view, 2>, 4> kTexcoords{
      {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}};
  for (const auto& names : kTexcoords) {
    if (!find_all(vertices.element, names, found))
      continue;
    layout.texcoords = true;
    assign_slots(vertices, std::span(found).first(2), layout.texcoord_offset());
    break;
  }
  if (layout.texcoords && writer_ == PlyWrittenBy::import)
    plan_materials(vertices);
}

void Planner::plan_materials(PlyElementPlan& vertices) {
  const int found = find_scalar(vertices.element, "material");
  if (found < 0)
    return;
  plan_.attributes.material = true;
  assign_slots(vertices, std::span(&found, 1), plan_.attributes.material_offset());
}

ColourType colour_type(PlyType type) {
  if (!is_integer(type))
    return ColourType::f32;
  return type == PlyType::u16 ? ColourType::u16 : ColourType::u8;
}

void Planner::plan_colours(PlyElementPlan& vertices) {
  constexpr std::array<std::array<std::string_view, 5>, 4> kColours{
      {{"red", "green", "blue", "alpha", "a"},
       {"r", "g", "b", "a", "alpha"},
       {"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha", "alpha"},
       {kLinearColours[0], kLinearColours[1], kLinearColours[2], "alpha", "a"}}};
  const PlyElement& element = vertices.element;
  const auto type_of = [&](int property) {
    return element.properties[static_cast<std::size_t>(property)].type;
  };
  for (const auto& names : kColours) {
    const bool is_light = names[0] == kLinearColours[0];
    if (is_light && writer_ != PlyWrittenBy::import)
      continue;
    std::array<int, 4> found{};
    if (!find_all(element, std::span(names).first(3), found))
      continue;
    const PlyType type = type_of(found[0]);
    if (type_of(found[1]) != type || type_of(found[2]) != type)
      continue;
    found[3] = find_scalar(element, names[3]);
    if (found[3] < 0)
      found[3] = find_scalar(element, names[4]);
    plan_.attributes.colour = colour_type(type);
    plan_.attributes.space = is_light ? ColourSpace::linear : ColourSpace::srgb;
    plan_.attributes.alpha = found[3] >= 0 && type_of(found[3]) == type;
    plan_.check_colours = is_integer(type) && type != PlyType::u8 && type != PlyType::u16;
    const auto count = static_cast<std::size_t>(plan_.attributes.colour_channels());
    assign_slots(vertices, std::span(found).first(count), plan_.attributes.colour_offset());
    return;
  }
}

void Planner::plan_faces(PlyElementPlan& plan) const {
  const PlyElement& element = plan.element;
  if (element.name != "face" && element.name != "tristrips")
    return;
  if (element.count == 0)
    return;
  std::size_t lists = 0;
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (property.name != "vertex_indices" && property.name != "vertex_index")
      continue;
    if (!property.is_list())
      continue;
    ++lists;
    plan.corners = i;
  }
  if (lists != 1) {
    fail(fmt::format(
        "expected one list property 'vertex_indices' or 'vertex_index' of element {}, found {}",
        in_quotes(element.name), lists));
  }
  const PlyType type = element.properties[plan.corners].type;
  if (!is_integer(type)) {
    fail(fmt::format("expected an integer type for the vertex indices of element {}, found '{}'",
                     in_quotes(element.name), name_of(type)));
  }
  plan.role = element.name == "face" ? Role::polygons : Role::strips;
}

void Planner::plan_textures() {
  if (header_.texture_files.empty())
    return;
  bool has_coordinates = plan_.attributes.texcoords;
  for (PlyElementPlan& plan : plan_.elements) {
    if (plan.role == Role::polygons)
      plan_face_textures(plan);
    has_coordinates = has_coordinates || plan.texcoords;
  }
  if (has_coordinates)
    plan_.texture_files = header_.texture_files;
}

void Planner::plan_face_textures(PlyElementPlan& plan) const {
  const std::vector<PlyProperty>& properties = plan.element.properties;
  for (std::size_t i = 0; i < properties.size(); ++i) {
    const PlyProperty& property = properties[i];
    if (property.is_list() && property.name == "texcoord" && i != plan.corners && !plan.texcoords)
      plan.texcoords = i;
    if (!property.is_list() && property.name == "texnumber" && is_integer(property.type))
      plan.texnumber = i;
  }
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

}  // namespace

PlyPlan make_ply_plan(const PlyHeader& header, std::uint64_t file_bytes,
                      const std::filesystem::path& path, PlyWrittenBy writer) {
  return Planner(header, file_bytes, path, writer).plan();
}

}  // namespace meshhier::mesh_io
