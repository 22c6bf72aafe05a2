#include "mesh_io/ply_faces.h"

#include "mesh_io/ply_body.h"

#include <cmath>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

/// Takes a row's vertex indices below `count`.
std::string take_corners(const PlyElementPlan& plan, const PlyRow& row, std::uint64_t count,
                         std::vector<std::uint32_t>& corners) {
  corners.clear();
  for (const double index : row.values[plan.corners]) {
    if (!(index >= 0 && index < static_cast<double>(count)))
      return index_text(plan, row.number, static_cast<std::int64_t>(index), count);
    corners.push_back(static_cast<std::uint32_t>(index));
  }
  return {};
}

std::string take_texture(const PlyElementPlan& plan, const PlyRow& row, std::size_t textures,
                         std::int32_t& texture) {
  texture = 0;
  if (!plan.texnumber)
    return {};
  const double number = row.values[*plan.texnumber][0];
  if (!(number >= -1 && number < static_cast<double>(textures))) {
    return fmt::format(
        "expected the number of one of {} texture files, from 0 on, or -1 for none, "
        "as '{}' in {}, found {}",
        textures, plan.element.properties[*plan.texnumber].name, row_name(plan, row.number),
        number);
  }
  texture = static_cast<std::int32_t>(number);
  return {};
}

std::string take_texcoords(const PlyElementPlan& plan, const PlyRow& row, PlyFace& face) {
  face.texcoords.clear();
  if (!plan.texcoords)
    return {};
  const std::vector<double>& values = row.values[*plan.texcoords];
  const std::size_t expected = 2 * face.corners.size();
  if (!values.empty() && values.size() != expected) {
    return fmt::format(
        "expected {} numbers or none, two a corner, in list '{}' of {}, found "
        "{}",
        expected, plan.element.properties[*plan.texcoords].name, row_name(plan, row.number),
        values.size());
  }
  for (const double value : values)
    face.texcoords.push_back(static_cast<float>(value));
  return {};
}

std::string take_colour(const PlyElementPlan& plan, const PlyRow& row, PlyFace& face) {
  face.colour = {};
  for (std::size_t c = 0; c < plan.colour.size(); ++c) {
    const PlyProperty& property = plan.element.properties[plan.colour[c]];
    const double value = row.values[plan.colour[c]][0];
    const bool is_byte = is_integer(property.type) && property.type != PlyType::u16;
    if (!std::isfinite(value) || (is_byte && !(value >= 0 && value <= 255))) {
      return fmt::format("expected {} as '{}' in {}, found {}",
                         is_byte ? "an integer from 0 to 255" : "a finite number", property.name,
                         row_name(plan, row.number), value);
    }
    face.colour[c] = static_cast<float>(value);
  }
  return {};
}

void take_values(const PlyElementPlan& plan, const PlyRow& row, PlyFace& face) {
  face.values.clear();
  for (const std::size_t property : plan.values)
    face.values.push_back(row.values[property][0]);
}

}  // namespace

std::string take_face(const PlyElementPlan& plan, const PlyRow& row, const PlyFaceLimits& limits,
                      PlyFace& face) {
  face.row = row.number;
  take_values(plan, row, face);
  std::string defect = take_corners(plan, row, limits.vertices, face.corners);
  if (defect.empty())
    defect = take_texture(plan, row, limits.textures, face.texture);
  if (defect.empty())
    defect = take_texcoords(plan, row, face);
  return defect.empty() ? take_colour(plan, row, face) : defect;
}

std::string take_texture_face(const PlyElementPlan& plan, const PlyRow& row,
                              const PlyFaceLimits& limits, PlyTextureFace& face) {
  std::string defect = take_corners(plan, row, limits.vertices, face.corners);
  if (defect.empty())
    defect = take_texture(plan, row, limits.textures, face.texture);
  if (!defect.empty())
    return defect;
  const double number = plan.face ? row.values[*plan.face][0] : static_cast<double>(row.number);
  if (!(number >= 0 && number < static_cast<double>(limits.faces))) {
    return fmt::format("expected the number of one of {} faces, from 0 on, for {}, found {}",
                       limits.faces, row_name(plan, row.number), number);
  }
  face.face = static_cast<std::uint64_t>(number);
  return {};
}

}  // namespace meshhier::mesh_io
