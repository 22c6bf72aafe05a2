#include "mesh_io/ply_face_plan.h"

#include "mesh_io/input_error.h"
#include "mesh_io/ply_properties.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Role = PlyElementPlan::Role;

void plan_corners(PlyElementPlan& plan, const std::filesystem::path& path) {
  const PlyElement& element = plan.element;
  if ((element.name != "face" && element.name != "tristrips") || element.count == 0)
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
    fail_file(path, fmt::format("expected one list property 'vertex_indices' or 'vertex_index' of "
                                "element {}, found {}",
                                in_quotes(element.name), lists));
  }
  const PlyType type = element.properties[plan.corners].type;
  if (!is_integer(type)) {
    fail_file(path, fmt::format("expected an integer type for the vertex indices of element {}, "
                                "found '{}'",
                                in_quotes(element.name), name_of(type)));
  }
  plan.role = element.name == "face" ? Role::polygons : Role::strips;
}

std::optional<std::size_t> find_integer(const PlyElement& element, std::string_view name,
                                        const std::filesystem::path& path) {
  const int found = find_scalar(element, name, path);
  if (found < 0 || !is_integer(element.properties[static_cast<std::size_t>(found)].type))
    return std::nullopt;
  return static_cast<std::size_t>(found);
}

PlyElementPlan* find_element(PlyPlan& plan, std::string_view name) {
  const auto found = std::ranges::find_if(
      plan.elements, [&](const PlyElementPlan& one) { return one.element.name == name; });
  return found == plan.elements.end() || found->element.count == 0 ? nullptr : &*found;
}

/// Plans Artec Studio's texture faces: each corner of a face names a texture vertex.
bool plan_texture_faces(PlyPlan& plan, const std::filesystem::path& path) {
  PlyElementPlan* const vertices = find_element(plan, "multi_texture_vertex");
  PlyElementPlan* const faces = find_element(plan, "multi_texture_face");
  const PlyElementPlan* const polygons = find_element(plan, "face");
  if (vertices == nullptr || faces == nullptr || polygons == nullptr)
    return false;
  constexpr std::array<std::string_view, 2> kTexcoord{"u", "v"};
  constexpr std::array<std::string_view, 1> kCorners{"texture_vertex_indices"};
  std::array<int, 2> texcoord{};
  const auto corners = find_list(faces->element, kCorners);
  if (!find_all(vertices->element, kTexcoord, texcoord, path) || !corners ||
      !is_integer(faces->element.properties[*corners].type))
    return false;
  vertices->role = Role::texture_vertices;
  vertices->texcoord = {static_cast<std::size_t>(texcoord[0]),
                        static_cast<std::size_t>(texcoord[1])};
  faces->role = Role::texture_faces;
  faces->corners = *corners;
  faces->texnumber = find_integer(faces->element, "tx", path);
  faces->face = find_integer(faces->element, "tn", path);
  return true;
}

constexpr std::array<std::string_view, 8> kFaceTexcoords{
    "texcoord", "texcoords",     "texture_coordinates", "texture_coords",
    "uv",       "texture_coord", "tex_coords",          "tex_coord"};

/// Returns whether faces have coordinates of their own.
bool plan_face_texcoords(PlyElementPlan& plan, const std::filesystem::path& path) {
  plan.texcoords = find_list(plan.element, kFaceTexcoords);
  for (const std::string_view name : kPlyTextureNumbers) {
    if (!plan.texnumber)
      plan.texnumber = find_integer(plan.element, name, path);
  }
  return plan.texcoords.has_value();
}

void plan_textures(PlyPlan& plan, const std::vector<std::string>& names,
                   const std::filesystem::path& path) {
  if (plan_texture_faces(plan, path)) {
    plan.texcoords = PlyTexcoords::of_texture_faces;
    plan.texture_files = names;
    return;
  }
  if (names.empty()) {
    plan.has_unnamed_texcoords = std::ranges::any_of(plan.elements, [](const PlyElementPlan& one) {
      return one.role == Role::polygons && find_list(one.element, kFaceTexcoords).has_value();
    });
    return;
  }
  if (plan.attributes.texcoords)
    plan.texcoords = PlyTexcoords::of_vertices;
  bool is_numbered = false;
  for (PlyElementPlan& one : plan.elements) {
    if (one.role != Role::polygons)
      continue;
    if (plan_face_texcoords(one, path))
      plan.texcoords = PlyTexcoords::of_faces;
    is_numbered = one.texnumber.has_value();
  }
  if (plan.texcoords == PlyTexcoords::none) {
    plan.unused_pictures = names;
    for (PlyElementPlan& one : plan.elements)
      one.texnumber.reset();
    return;
  }
  plan.texture_files = names;
  if (!is_numbered)
    plan.unused_pictures.assign(names.begin() + 1, names.end());
}

void plan_face_colours(PlyPlan& plan, const std::filesystem::path& path) {
  if (plan.attributes.has_colours())
    return;
  for (PlyElementPlan& one : plan.elements) {
    if (one.role != Role::polygons)
      continue;
    for (const PlyColourNames& names : kPlyColours) {
      const auto found = find_colour(one.element, names, path);
      if (!found)
        continue;
      plan.face_colour = found->kind;
      plan.face_alpha = found->properties.size() == 4 && found->kind != ColourType::f32;
      for (std::size_t c = 0; c < (plan.face_alpha ? 4 : 3); ++c)
        one.colour.push_back(static_cast<std::size_t>(found->properties[c]));
      return;
    }
  }
}

}  // namespace

void plan_faces(PlyPlan& plan, const std::vector<std::string>& texture_files,
                const std::filesystem::path& path) {
  for (PlyElementPlan& element : plan.elements)
    plan_corners(element, path);
  plan_textures(plan, texture_files, path);
  plan_face_colours(plan, path);
}

}  // namespace meshhier::mesh_io
