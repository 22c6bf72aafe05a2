// The content of an OBJ file in spools, before its corners become vertices.
#pragma once

#include "import/material_libraries.h"
#include "import/obj_labels.h"
#include "import/obj_objects.h"
#include "import/place_lookup.h"
#include "import/raw_mesh.h"
#include "mesh_io/obj_reader.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

namespace meshhier::importing {

/// The colour in a spool of a position that has none. No file has such a colour.
inline constexpr mesh_io::ObjColour kNoColour{std::numeric_limits<float>::infinity()};

inline bool is_colour(const mesh_io::ObjColour& colour) {
  return colour[0] != kNoColour[0];
}

inline bool has_texcoords(const mesh_io::ObjTriangle& triangle) {
  return std::ranges::all_of(triangle, [](const mesh_io::ObjCorner& corner) {
    return corner.texcoord != mesh_io::ObjCorner::kNone;
  });
}

/// All that a file holds, as it stands there. For one thread.
class ObjParts final : public mesh_io::ObjVisitor {
 public:
  using ObjColour = mesh_io::ObjColour;
  using ObjTriangle = mesh_io::ObjTriangle;
  using Texcoord = std::array<float, 2>;

  /// `mesh` gets names of labels, and objects. Materials count if `keeps_materials`.
  ObjParts(const std::filesystem::path& path, const mesh_io::AttributeChoice& attributes,
           bool keeps_materials, RawMesh& mesh, storage::ScratchFile& scratch)
      : names(path),
        labels(attributes, mesh.label_names),
        objects(mesh.objects.get(), scratch),
        positions(scratch, kImportSpoolBytes),
        colours(scratch, kImportSpoolBytes),
        texcoords(scratch, kImportSpoolBytes),
        normals(scratch, kImportSpoolBytes),
        triangles(scratch, kImportSpoolBytes),
        materials(scratch, kImportSpoolBytes),
        combinations(scratch, kImportSpoolBytes),
        keeps_materials_(keeps_materials),
        places_(positions) {}

  void add_position(Vec3d position, const std::optional<ObjColour>& colour) override {
    positions.append(position);
    if (colour && !has_colours_) {
      colours.clear();  // those of ZBrush
      has_colours_ = true;
      for (std::uint64_t i = 1; i < positions.size(); ++i)
        colours.append(kNoColour);
    }
    if (has_colours_)
      colours.append(colour.value_or(kNoColour));
  }
  void add_polypaint(const ObjColour& colour) override {
    if (!has_colours_)
      colours.append(colour);
  }
  /// Returns whether colours of ZBrush count: they are those of all vertices, or of none, and then
  /// goes without them. Asked once all is there.
  bool has_polypaint() {
    if (has_colours_ || colours.size() == 0)
      return false;
    if (colours.size() != positions.size())
      colours.clear();
    return colours.size() > 0;
  }
  Vec3d position(std::uint32_t number) override { return places_.at(number); }
  void add_texcoord(Texcoord texcoord) override { texcoords.append(texcoord); }
  void add_normal(Vec3f normal) override { normals.append(normal); }
  void use_material(const std::string& name) override {
    if (keeps_materials_)
      names.begin(name);
    begin(ObjLabel::material, name);
  }
  bool takes_groups() const override { return labels.are_asked() || objects.are_asked(); }
  void use_group(const std::string& group) override { begin(ObjLabel::group, group); }
  void use_object(const std::string& name) override { begin(ObjLabel::object, name); }
  void use_libraries(const std::string& statement) override {
    if (keeps_materials_)
      names.add_libraries(statement);
  }
  void add_triangle(const ObjTriangle& triangle) override {
    triangles.append(triangle);
    if (keeps_materials_)
      materials.append(names.use(has_texcoords(triangle)));
    if (labels.are_asked())
      combinations.append(labels.use());
  }

  mesh_io::ObjCounts counts;  ///< of all that was read
  MaterialNames names;
  ObjLabels labels;
  ObjObjects objects;
  storage::RecordSpool<Vec3d> positions;
  storage::RecordSpool<ObjColour> colours;  ///< none, or one a position, perhaps kNoColour
  storage::RecordSpool<Texcoord> texcoords;
  storage::RecordSpool<Vec3f> normals;
  storage::RecordSpool<ObjTriangle> triangles;
  storage::RecordSpool<std::uint32_t> materials;     ///< number in `names`, one a triangle; or none
  storage::RecordSpool<std::uint32_t> combinations;  ///< number in `labels`, likewise

 private:
  void begin(ObjLabel statement, const std::string& name) {
    labels.begin(statement, name);
    objects.begin(statement, name, triangles.size());
  }

  bool keeps_materials_;
  bool has_colours_ = false;  ///< lines v have colours
  SpoolLookup<Vec3d> places_;
};

}  // namespace meshhier::importing
