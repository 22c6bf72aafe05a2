#include "export/plan_part.h"

#include "base/srgb.h"
#include "images/image_codec.h"
#include "render/vertex_light.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace meshhier::exporting {
namespace {

/// Returns the normals of vertices as the triangles around have them, of any length.
std::vector<Vec3f> normals_of_triangles(const CutPart& part) {
  std::vector<Vec3d> sums(part.vertices.size());
  const auto at = [&](std::uint32_t v) { return to_double(part.vertices.positions[v]); };
  for (const auto& t : part.triangles) {
    const Vec3d normal = cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0]));
    for (const std::uint32_t corner : t)
      sums[corner] = sums[corner] + normal;
  }
  std::vector<Vec3f> normals;
  normals.reserve(sums.size());
  for (const Vec3d& sum : sums)
    normals.push_back(to_float(sum));
  return normals;
}

/// Returns the computed normals, else those of the input, else those of the triangles.
std::vector<Vec3f> normals_of(const AttributeLayout& layout, const CutPart& part) {
  if (!part.normals.empty())
    return part.normals;
  const AttributePart given = layout.part(AttributeKind::normals);
  if (given.count == 0)
    return normals_of_triangles(part);
  std::vector<Vec3f> normals;
  for (std::size_t v = 0; v < part.vertices.size(); ++v) {
    const auto normal = given.of(part.vertices.attributes_of(v));
    normals.push_back({normal[0], normal[1], normal[2]});
  }
  return normals;
}

/// Returns the light that a slope sends up; both of its sides are alike.
float relief_light(const PlanView& view, Vec3f normal) {
  const MapFrame& frame = view.frame;
  constexpr Vec3d kSun{-0.5, 0.5, 0.70710678118654752};
  constexpr double kDarkest = 0.1;  // slopes away from the sun
  const Vec3d n = to_double(normal);
  Vec3d map{dot(frame.rows[0], n), dot(frame.rows[1], n), dot(frame.rows[2], n)};
  const double size = length(map);
  if (!(size > 0) || !std::isfinite(size))
    map = {0, 0, 1};
  else
    map = map * ((map.z < 0 ? -1 : 1) / size);
  const double sun = dot(map, kSun);
  return static_cast<float>(light_of(view.is_soft ? (1 + sun) / 2 : std::max(sun, kDarkest)));
}

std::vector<Vec3f> relief_lights(const PlanView& view, const CutPart& part) {
  std::vector<Vec3f> lights;
  lights.reserve(part.vertices.size());
  for (const Vec3f& normal : normals_of(view.layout, part)) {
    const float light = relief_light(view, normal);
    lights.push_back({light, light, light});
  }
  return lights;
}

std::vector<Vec3f> colour_lights(const PlanView& view, const CutPart& part) {
  const render::VertexLight light(view.layout);
  std::vector<Vec3f> lights;
  lights.reserve(part.vertices.size());
  for (std::size_t v = 0; v < part.vertices.size(); ++v)
    lights.push_back(light.of(part.vertices.attributes_of(v)));
  return lights;
}

/// Returns the light of vertices; nothing if a picture says all.
std::vector<Vec3f> lights_of(const PlanView& view, const CutPart& part) {
  const bool is_tinted = view.layout.tints && view.layout.has_colours();
  if (!part.image.empty())
    return is_tinted ? colour_lights(view, part) : std::vector<Vec3f>{};
  return view.layout.has_colours() ? colour_lights(view, part) : relief_lights(view, part);
}

std::unique_ptr<const render::MipTexture> texture_of(const TileImage& image,
                                                     const std::string& name) {
  const std::uint64_t texels = std::uint64_t{image.width} * image.height;
  return std::make_unique<const render::MipTexture>(images::decode_image(image.bytes, name, texels),
                                                    render::Wraps{Wrap::clamp, Wrap::clamp},
                                                    image.alpha);
}

}  // namespace

render::PlanMesh plan_mesh(const PlanView& view, CutPart part, const std::string& picture) {
  render::PlanMesh mesh;
  mesh.places.reserve(part.vertices.size());
  for (const Vec3f& position : part.vertices.positions)
    mesh.places.push_back(view.grid.on_grid(view.frame(position)));
  if (view.has_colours)
    mesh.lights = lights_of(view, part);
  if (!part.image.empty() && (view.has_colours || part.image.alpha != AlphaMode::opaque)) {
    mesh.texture = texture_of(part.image, picture);
    mesh.texcoords = std::move(part.texcoords);
  }
  mesh.triangles = std::move(part.triangles);
  return mesh;
}

}  // namespace meshhier::exporting
