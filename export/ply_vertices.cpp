#include "export/ply_vertices.h"

#include "base/srgb.h"

#include <algorithm>
#include <span>
#include <vector>

namespace meshhier::exporting {
namespace {

bool has_origin(const storage::HierarchyReader& reader) {
  return reader.manifest().origin != Vec3d{};
}

/// Returns attributes with colours as PLY has them: sRGB instead of light.
std::vector<float> screen_attributes(const AttributeLayout& layout, std::span<const float> given) {
  const auto channels = static_cast<std::size_t>(layout.channels());
  std::vector<float> attributes(given.begin(), given.end());
  const double full = full_number(layout.colour);
  for (std::size_t v = 0; v < attributes.size(); v += channels) {
    float* colour = &attributes[v + layout.part(AttributeKind::colours).first];
    std::transform(colour, colour + 3, colour,
                   [&](float x) { return static_cast<float>(full * value_of(x / full)); });
  }
  return attributes;
}

}  // namespace

mesh_io::PlyContent ply_content(const storage::HierarchyReader& reader, const std::string& what) {
  mesh_io::PlyContent content;
  content.attributes = reader.tile_format().attributes;
  content.attributes.space = ColourSpace::srgb;
  content.attributes.tints = false;
  content.double_coordinates = has_origin(reader);
  content.comments = {"meshhier export: " + what};
  return content;
}

void write_vertices(mesh_io::PlyWriter& writer, const storage::HierarchyReader& reader,
                    const VertexArray& vertices, std::size_t count) {
  const auto positions = std::span(vertices.positions).first(count);
  const auto given =
      std::span(vertices.attributes).first(count * static_cast<std::size_t>(vertices.channels));
  const AttributeLayout& layout = reader.tile_format().attributes;
  std::vector<float> converted;
  if (layout.space == ColourSpace::linear)
    converted = screen_attributes(layout, given);
  const std::span<const float> attributes = converted.empty() ? given : std::span(converted);
  if (!has_origin(reader))
    return writer.write_vertices(positions, attributes);
  std::vector<Vec3d> exact(count);
  std::transform(positions.begin(), positions.end(), exact.begin(),
                 [&](Vec3f p) { return to_double(p) + reader.manifest().origin; });
  writer.write_vertices(exact, attributes);
}

}  // namespace meshhier::exporting
