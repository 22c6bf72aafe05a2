#include "import/gltf_import.h"

#include "import/gltf_copies.h"
#include "import/gltf_objects.h"
#include "import/gltf_vertices.h"
#include "import/unread_metadata.h"
#include "import/used_vertices.h"
#include "mesh_io/gltf_scene.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using mesh_io::GltfComponent;
using mesh_io::GltfElementSource;
using mesh_io::GltfFile;
using mesh_io::GltfPrimitive;
using mesh_io::GltfTransform;

ColourType colour_type(GltfComponent component) {
  return component == GltfComponent::u8    ? ColourType::u8
         : component == GltfComponent::u16 ? ColourType::u16
                                           : ColourType::f32;
}

/// The attributes that the primitives of a file have together.
class CommonLayout {
 public:
  void add(const GltfFile& file, const GltfPrimitive& primitive, const std::string& texcoords) {
    for (const AttributeKindRow& row : kAttributeKinds) {
      const std::string name = gltf_name(row, texcoords);
      const auto accessor = name.empty() ? std::nullopt : primitive.attribute(name);
      if (!accessor)
        continue;
      if (row.kind == AttributeKind::colours)
        add_colour(file.document().accessors[*accessor]);
      else
        layout_.*row.flag = true;
    }
  }
  const AttributeLayout& layout() const { return layout_; }

 private:
  /// One type for all: floats hold the others.
  void add_colour(const mesh_io::GltfAccessor& accessor) {
    const ColourType type = colour_type(accessor.component);
    layout_.colour = !layout_.has_colours() || layout_.colour == type ? type : ColourType::f32;
    layout_.alpha = layout_.alpha || accessor.components == 4;
  }

  AttributeLayout layout_;
};

/// A mesh has up to 2^32 vertices, and about twice as many triangles.
constexpr double kMostShown = 8589934592;

/// Triangles at most, as its accessors say.
double triangle_count(const mesh_io::GltfDocument& document, const GltfPrimitive& primitive) {
  const auto corners = primitive.indices ? primitive.indices : primitive.attribute("POSITION");
  const auto count = static_cast<double>(document.accessors[corners.value()].count);
  return primitive.mode == GltfPrimitive::Mode::triangles ? count / 3 : count;
}

class GltfImporter {
 public:
  GltfImporter(GltfFile& file, const GltfPlace& place, RawMesh& mesh, Textures textures,
               const mesh_io::AttributeChoice& attributes, const ImportRoom& room)
      : file_(file),
        mesh_(mesh),
        textures_(textures),
        room_(room),
        scene_(gltf_scene(file.document(), file.path(), place.placement)),
        objects_(file, scene_, mesh, place, room),
        materials_(file),
        found_values_(attributes) {}

  AddedFile run() {
    look();
    require_readable_pictures();
    materials_.tell_missing(mesh_.materials);
    if (is_textured())
      materials_.add_to(mesh_.materials);
    for (const mesh_io::GltfInstance& instance : scene_.instances) {
      const std::vector<GltfTransform>& joints = joints_of(instance);
      added_.count("skinned_meshes", joints.empty() ? 0 : 1);
      objects_.begin(instance);
      std::uint64_t copy = 0;
      for_each_copy(file_, instance, [&](const GltfTransform& transform) {
        objects_.begin_copy(instance.copies ? ++copy : 0);
        for (const GltfPrimitive& primitive : primitives(instance))
          append(primitive, transform, joints);
      });
      added_.count("instanced_meshes", copy);
    }
    return finish();
  }

 private:
  const std::vector<GltfPrimitive>& primitives(const mesh_io::GltfInstance& instance) const {
    return file_.document().meshes[instance.mesh].primitives;
  }

  /// Throws if the file requires pictures of a format that is not read.
  void require_readable_pictures() const {
    if (textures_ == Textures::ignore)
      return;
    for (const mesh_io::GltfPictureFormat* format : materials_.unread_formats()) {
      if (std::ranges::find(file_.document().required, format->extension) ==
          file_.document().required.end())
        continue;
      file_.fail(
          fmt::format("requires {}: its pictures are in {}, which is not read; export them "
                      "as PNG or JPEG, or leave them out with \"texture\": {{\"use\": "
                      "false}}",
                      format->extension, format->name));
    }
  }

  /// The matrices of the skin that places it; empty if its node does.
  const std::vector<GltfTransform>& joints_of(const mesh_io::GltfInstance& instance) {
    static const std::vector<GltfTransform> kNone;
    if (!instance.skin)
      return kNone;
    const bool hangs_on_joints =
        !instance.copies && std::ranges::any_of(primitives(instance), importing::is_skinned);
    if (hangs_on_joints)
      return joints_of_skin(*instance.skin);
    added_.count("ignored_skins", 1);
    return kNone;
  }

  /// Many nodes may have it.
  const std::vector<GltfTransform>& joints_of_skin(std::uint32_t skin) {
    auto known = skins_.find(skin);
    if (known == skins_.end())
      known =
          skins_.emplace(skin, joint_matrices(file_, file_.document().skins[skin], scene_)).first;
    return known->second;
  }

  bool is_shown(const GltfPrimitive& primitive) const {
    return primitive.has_triangles() && primitive.attribute("POSITION") && !is_invisible(primitive);
  }
  bool is_invisible(const GltfPrimitive& primitive) const {
    return primitive.material && file_.document().materials[*primitive.material].is_invisible();
  }

  bool is_textured() const { return textures_ == Textures::use && materials_.is_textured(); }

  /// Finds out what all primitives have, before any is read.
  void look() {
    std::set<std::uint32_t> meshes;
    CommonLayout layout;
    for (const mesh_io::GltfInstance& instance : scene_.instances) {
      if (!meshes.insert(instance.mesh).second) {
        added_.count("repeated_meshes", 1);
        continue;
      }
      for (const GltfPrimitive& primitive : primitives(instance))
        look_at(primitive, layout);
    }
    require_few_triangles();
    added_.layout = layout.layout();
    values_ = found_values_.values();
    for (const GltfValue& value : values_)
      added_.layout.values.push_back(value.attribute);
    complete_layout();
  }

  void require_few_triangles() const {
    double shown = 0;
    for (const mesh_io::GltfInstance& instance : scene_.instances) {
      const auto copies = static_cast<double>(copy_count(file_.document(), instance));
      for (const GltfPrimitive& primitive : primitives(instance))
        shown += is_shown(primitive) ? copies * triangle_count(file_.document(), primitive) : 0;
    }
    if (shown > kMostShown)
      file_.fail(
          fmt::format("shows {:.0f} triangles, as its nodes show meshes many times; up to "
                      "{:.0f} are read",
                      shown, kMostShown));
  }

  /// Adds what the materials give.
  void complete_layout() {
    AttributeLayout& layout = added_.layout;
    if (is_textured()) {
      layout.texcoords = layout.material = true;
    } else if (!layout.has_colours() && materials_.colours().are_seen()) {
      layout.colour = PlainColours::kType;
      added_.material_colours = materials_.colours().count();
      added_.is_painted = true;
    } else if (layout.has_colours() && (materials_.colours().are_coloured() || materials_.emit())) {
      added_.material_colours = materials_.colours().count();
      // Products of light with 8 bits would be bands.
      widens_colours_ = layout.colour == ColourType::u8;
      if (widens_colours_)
        layout.colour = ColourType::u16;
    }
    if (layout.has_colours() && !added_.is_painted)
      layout.space = ColourSpace::linear;
    layout.tints = layout.material && layout.has_colours();
  }

  void look_at(const GltfPrimitive& primitive, CommonLayout& layout) {
    added_.count("ignored_morph_targets", primitive.morph_targets);
    if (!is_shown(primitive)) {
      const bool is_hidden = primitive.has_triangles() && is_invisible(primitive);
      added_.count(is_hidden ? kInvisibleParts : kPointsAndLines, 1);
      return;
    }
    const std::string texcoords = materials_.texcoords(primitive.material);
    layout.add(file_, primitive, texcoords);
    found_values_.add(file_.document(), primitive);
    if (textures_ == Textures::use)
      materials_.use(primitive.material, primitive.attribute(texcoords).has_value());
  }

  /// `joints`: of the skin that places it; else `transform` does.
  void append(const GltfPrimitive& primitive, const GltfTransform& transform,
              const std::vector<GltfTransform>& joints) {
    if (!is_shown(primitive))
      return;
    const PrimitiveSources sources(file_, primitive);
    const GltfElementSource position = *sources.attribute("POSITION", 3, 3);
    storage::RecordSpool<std::uint32_t> used(room_.scratch, kImportSpoolBytes);
    const bool has_joints = !joints.empty() && importing::is_skinned(primitive);
    const bool is_turned = has_joints ? are_mirrored(joints) : is_mirrored(transform);
    const std::uint64_t before = mesh_.triangles.size();
    append_used(read_triangles(sources, position), position.count, is_turned, mesh_, used, room_);
    objects_.add(primitive, sources, before, used, position.count);
    added_.count("vertices_left_out", position.count - used.size());
    std::optional<GltfSkinning> skin;
    if (has_joints)
      skin.emplace(file_, primitive, sources, joints, position.count);
    append_vertices({sources, position, materials_, values_, widens_colours_}, used,
                    {transform, skin ? &*skin : nullptr}, added_, mesh_, room_);
  }

  using Triangles = storage::RecordSpool<Triangle<std::uint32_t>>;

  std::unique_ptr<Triangles> read_triangles(const PrimitiveSources& sources,
                                            const GltfElementSource& position) {
    auto triangles = std::make_unique<Triangles>(room_.scratch, kImportSpoolBytes);
    const mesh_io::FaceCounts counts =
        sources.read_triangles(position, [&](std::span<const Triangle<VertexId>> block) {
          room_.cancel.check();
          for (const Triangle<VertexId>& t : block)
            triangles->append(Triangle<std::uint32_t>{raw(t[0]), raw(t[1]), raw(t[2])});
        });
    added_.faces += counts.triangles + counts.degenerate_triangles;
    added_.degenerate_triangles += counts.degenerate_triangles;
    return triangles;
  }

  AddedFile finish() {
    added_.count("ignored_animations", file_.document().animations);
    added_.count("ignored_cameras", scene_.cameras);
    added_.count(kMadeOpaque, is_textured() ? 0 : materials_.translucent());
    added_.count(kIgnoredTechniques, materials_.unknown());
    added_.count("hidden_meshes", scene_.hidden);
    added_.count(kIgnoredEmission, materials_.dropped_lights(is_textured()));
    added_.count("dropped_values", found_values_.dropped());
    added_.count(objects_.unread());
    return std::move(added_);
  }

  GltfFile& file_;
  RawMesh& mesh_;
  Textures textures_;
  const ImportRoom& room_;
  mesh_io::GltfScene scene_;
  GltfObjects objects_;
  GltfMaterials materials_;
  AddedFile added_;
  GltfValues found_values_;
  std::vector<GltfValue> values_;  ///< those of the layout
  bool widens_colours_ = false;    ///< from 8 bits to 16
  std::map<std::uint32_t, std::vector<GltfTransform>> skins_;
};

}  // namespace

AddedFile import_gltf(mesh_io::GltfFile& file, const GltfPlace& place, RawMesh& mesh,
                      Textures textures, const mesh_io::AttributeChoice& attributes,
                      const ImportRoom& room) {
  return GltfImporter(file, place, mesh, textures, attributes, room).run();
}

}  // namespace meshhier::importing
