#include "export/obj_faces.h"

namespace meshhier::exporting {

void ObjFaces::add(std::uint32_t part, const CutPart& mesh) {
  std::uint32_t number = 0;
  for (const Triangle<std::uint32_t>& t : mesh.triangles) {
    const float* const attributes = mesh.vertices.attributes_of(t[0]).data();
    ObjFace face{static_cast<std::uint32_t>(object_.in(attributes)), part, number++, {}, {}};
    for (std::size_t i = 0; i < 3; ++i) {
      face.corners[i] = t[i];
      face.places[i] = mesh.places[t[i]];
    }
    faces_.add(face);
  }
}

void ObjFaces::for_each(const std::function<void(const ObjFace& face)>& visit) {
  faces_.sort();
  faces_.for_each_block([&](std::span<const ObjFace> block) {
    for (const ObjFace& face : block)
      visit(face);
  });
}

}  // namespace meshhier::exporting
