#include "import/gltf_import.h"

#include "base/angle.h"
#include "execution/spool_cursor.h"
#include "import/append_value.h"
#include "import/gltf_copies.h"
#include "import/gltf_materials.h"
#include "import/gltf_objects.h"
#include "import/gltf_primitive.h"
#include "import/gltf_skin.h"
#include "import/gltf_values.h"
#include "import/used_vertices.h"
#include "mesh_io/coordinate_range.h"
#include "mesh_io/gltf_elements.h"
#include "mesh_io/gltf_scene.h"
#include "mesh_io/mesh_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using mesh_io::GltfComponent;
using mesh_io::GltfElements;
using mesh_io::GltfElementSource;
using mesh_io::GltfFile;
using mesh_io::GltfPrimitive;
using mesh_io::GltfTransform;

ColourType colour_type(GltfComponent component) {
  return component == GltfComponent::u8    ? ColourType::u8
         : component == GltfComponent::u16 ? ColourType::u16
                                           : ColourType::f32;
}

/// Returns the name of an attribute; empty: glTF has none. `texcoords`: the set that is shown.
std::string name_of(const AttributeKindRow& row, const std::string& texcoords) {
  return row.kind == AttributeKind::texcoords ? texcoords : std::string(row.gltf);
}

/// The attributes that the primitives of a file have together.
class CommonLayout {
 public:
  void add(const GltfFile& file, const GltfPrimitive& primitive, const std::string& texcoords) {
    for (const AttributeKindRow& row : kAttributeKinds) {
      const std::string name = name_of(row, texcoords);
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

/// A texture coordinate of the picture; rotations are counter-clockwise with v pointing down, as
/// viewers have them.
std::array<double, 2> transformed(const mesh_io::GltfTextureTransform& t, double u, double v) {
  const UnitTurn turn = turn_by(std::remainder(t.rotation, 2 * std::numbers::pi));
  const double x = t.scale[0] * u, y = t.scale[1] * v;
  return {t.offset[0] + turn.cosine * x + turn.sine * y,
          t.offset[1] + turn.cosine * y - turn.sine * x};
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

  GltfImport run() {
    look();
    require_readable_pictures();
    materials_.tell_missing(mesh_.materials);
    if (is_textured())
      materials_.add_to(mesh_.materials);
    for (const mesh_io::GltfInstance& instance : scene_.instances) {
      const std::vector<GltfTransform>& joints = joints_of(instance);
      skinned_ += joints.empty() ? 0 : 1;
      objects_.begin(instance);
      std::uint64_t copy = 0;
      for_each_copy(file_, instance, [&](const GltfTransform& transform) {
        copies_ += instance.copies ? 1 : 0;
        objects_.begin_copy(instance.copies ? ++copy : 0);
        for (const GltfPrimitive& primitive : primitives(instance))
          append(primitive, transform, joints);
      });
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
    ++ignored_skins_;
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

  /// Returns the name of the coordinates that the material's texture takes.
  std::string texcoords_of(const GltfPrimitive& primitive) const {
    const mesh_io::GltfTextureUse* shown = materials_.look(primitive.material).texture;
    return fmt::format("TEXCOORD_{}", shown != nullptr ? shown->texcoord : 0);
  }

  bool is_textured() const { return textures_ == Textures::use && materials_.is_textured(); }

  /// Finds out what all primitives have, before any is read.
  void look() {
    std::set<std::uint32_t> meshes;
    CommonLayout layout;
    double shown = 0;
    for (const mesh_io::GltfInstance& instance : scene_.instances) {
      const auto copies = static_cast<double>(copy_count(file_.document(), instance));
      for (const GltfPrimitive& primitive : primitives(instance))
        shown += is_shown(primitive) ? copies * triangle_count(file_.document(), primitive) : 0;
      if (!meshes.insert(instance.mesh).second) {
        ++repeated_;
        continue;
      }
      for (const GltfPrimitive& primitive : primitives(instance))
        look_at(primitive, layout);
    }
    if (shown > kMostShown)
      file_.fail(
          fmt::format("shows {:.0f} triangles, as its nodes show meshes many times; up to "
                      "{:.0f} are read",
                      shown, kMostShown));
    import_.layout = layout.layout();
    values_ = found_values_.values();
    for (const GltfValue& value : values_)
      import_.layout.values.push_back(value.attribute);
    if (is_textured()) {
      import_.layout.texcoords = import_.layout.material = true;
    } else if (!import_.layout.has_colours() && materials_.colours().are_seen()) {
      import_.layout.colour = PlainColours::kType;
      import_.material_colours = materials_.colours().count();
      import_.is_painted = true;
    } else if (import_.layout.has_colours() &&
               (materials_.colours().are_coloured() || materials_.emit())) {
      import_.material_colours = materials_.colours().count();
      // Products of light with 8 bits would be bands.
      widens_colours_ = import_.layout.colour == ColourType::u8;
      if (widens_colours_)
        import_.layout.colour = ColourType::u16;
    }
    if (import_.layout.has_colours() && !import_.is_painted)
      import_.layout.space = ColourSpace::linear;
    import_.layout.tints = import_.layout.material && import_.layout.has_colours();
  }

  void look_at(const GltfPrimitive& primitive, CommonLayout& layout) {
    morph_targets_ += primitive.morph_targets;
    if (!is_shown(primitive)) {
      ++(primitive.has_triangles() && is_invisible(primitive) ? invisible_ : ignored_primitives_);
      return;
    }
    const std::string texcoords = texcoords_of(primitive);
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
    left_out_ += position.count - used.size();
    std::optional<GltfSkinning> skin;
    if (has_joints)
      skin.emplace(file_, primitive, sources, joints, position.count);
    append_vertices(primitive, sources, position, used,
                    [&](std::uint32_t vertex) { return skin ? skin->at(vertex) : transform; });
  }

  using Triangles = storage::RecordSpool<Triangle<std::uint32_t>>;

  std::unique_ptr<Triangles> read_triangles(const PrimitiveSources& sources,
                                            const GltfElementSource& position) {
    auto triangles = std::make_unique<Triangles>(room_.scratch, kImportSpoolBytes);
    const mesh_io::TriangleVisitor take = [&](std::span<const Triangle<VertexId>> block) {
      room_.cancel.check();
      for (const Triangle<VertexId>& t : block)
        triangles->append(Triangle<std::uint32_t>{raw(t[0]), raw(t[1]), raw(t[2])});
    };
    mesh_io::TriangleBlocks blocks(take);
    if (const auto source = sources.indices()) {
      GltfElements indices(file_, *source);
      assemble(sources.mode(), *source, blocks, [&](std::uint64_t i) {
        const double index = indices.at(i)[0];
        if (!(index < static_cast<double>(position.count))) {
          file_.fail(fmt::format("{}: element {} is {}, but there are {} vertices", source->name, i,
                                 index, position.count));
        }
        return static_cast<std::uint32_t>(index);
      });
    } else {
      assemble(sources.mode(), position, blocks,
               [](std::uint64_t i) { return static_cast<std::uint32_t>(i); });
    }
    const mesh_io::FaceCounts counts = blocks.finish();
    import_.triangles += counts.triangles + counts.degenerate_triangles;
    import_.degenerate_triangles += counts.degenerate_triangles;
    return triangles;
  }

  template <class Corner>
  void assemble(GltfPrimitive::Mode mode, const GltfElementSource& corners,
                mesh_io::TriangleBlocks& blocks, const Corner& corner) const {
    const std::uint64_t count = corners.count;
    if (mode == GltfPrimitive::Mode::triangles) {
      if (count % 3 != 0) {
        file_.fail(fmt::format("{} has {} elements for a list of triangles, expected three each",
                               corners.name, count));
      }
      for (std::uint64_t i = 0; i < count; i += 3) {
        const std::uint32_t a = corner(i), b = corner(i + 1);
        blocks.add_triangle_face(a, b, corner(i + 2));
      }
    } else if (mode == GltfPrimitive::Mode::strip) {
      blocks.begin_strip();
      for (std::uint64_t i = 0; i < count; ++i)
        blocks.add_strip_corner(corner(i));
    } else {
      blocks.begin_polygon();
      for (std::uint64_t i = 0; i < count; ++i)
        blocks.add_polygon_corner(corner(i));
    }
  }

  /// Reads an attribute of as many elements as there are vertices.
  std::optional<GltfElements> elements(const PrimitiveSources& sources, const std::string& name,
                                       std::uint32_t least, std::uint32_t most, std::uint64_t count,
                                       bool stored = false) const {
    auto source = sources.attribute(name, least, most);
    if (!source)
      return std::nullopt;
    if (source->count != count) {
      file_.fail(fmt::format("{} has {} elements for {}, POSITION has {}", source->name,
                             source->count, name, count));
    }
    source->normalized = source->normalized || name == row_of(AttributeKind::colours).gltf;
    return GltfElements(
        file_, *std::move(source),
        stored ? GltfElements::Integers::stored : GltfElements::Integers::fractions);
  }

  /// The attributes of a primitive that the mesh has.
  struct Attributes {
    std::array<std::optional<GltfElements>, kAttributeKindCount> given;  ///< but for values
    std::vector<std::optional<GltfElements>> values;                     ///< of values_
    // The material's, if vertices have its colour.
    std::array<double, 4> factor{1, 1, 1, 1};
    std::array<double, 3> light{};
    bool is_untinted = false;  ///< the material's picture is shown as it is
    float material = 0;
    const mesh_io::GltfTextureTransform* texture = nullptr;

    std::optional<GltfElements>& of(AttributeKind kind) {
      return given[static_cast<std::size_t>(kind)];
    }
  };

  Attributes attributes(const GltfPrimitive& primitive, const PrimitiveSources& sources,
                        std::uint64_t count) const {
    const AttributeLayout& layout = import_.layout;
    Attributes attributes;
    for (const AttributePart& part : layout.parts()) {
      const std::string name = name_of(row_of(part.kind), texcoords_of(primitive));
      const auto size = static_cast<std::uint32_t>(part.count);
      if (part.kind == AttributeKind::colours && size > 0)
        attributes.of(part.kind) =
            elements(sources, name, 3, 4, count, layout.colour != ColourType::f32);
      else if (size > 0 && !name.empty())
        attributes.of(part.kind) = elements(sources, name, size, size, count);
    }
    for (const GltfValue& value : values_)
      attributes.values.push_back(elements(sources, value.source, 1, 4, count, true));
    if (import_.material_colours > 0)
      attributes.factor = factor_of(primitive.material);
    if (import_.material_colours > 0 && !import_.is_painted && primitive.material)
      attributes.light = plain_light(file_.document().materials[*primitive.material]);
    attributes.is_untinted = layout.material && materials_.look(primitive.material).is_untinted;
    if (layout.material) {
      attributes.material = static_cast<float>(materials_.number(primitive.material));
      if (const auto* shown = materials_.look(primitive.material).texture)
        attributes.texture = &shown->transform;
    }
    return attributes;
  }

  /// Light, but as the 8-bit colours that vertices have if no primitive has any of its own.
  std::array<double, 4> factor_of(std::optional<std::uint32_t> material) const {
    if (import_.is_painted) {
      const auto [red, green, blue] = materials_.colour(material).channels;
      return {red / 255.0, green / 255.0, blue / 255.0, 1};
    }
    std::array<double, 4> factor{1, 1, 1, 1};
    if (material)
      factor = file_.document().materials[*material].factor;
    for (double& part : factor)
      part = std::clamp(part, 0.0, 1.0);
    return factor;
  }

  /// `place`: of a vertex.
  template <class Place>
  void append_vertices(const GltfPrimitive& primitive, const PrimitiveSources& sources,
                       const GltfElementSource& position,
                       const storage::RecordSpool<std::uint32_t>& used, const Place& place) {
    Attributes all = attributes(primitive, sources, position.count);
    count_filled(all, used.size());
    GltfElements positions(file_, position);
    execution::SpoolCursor vertices(used, room_.cancel);
    const AttributeParts parts = import_.layout.parts();
    std::vector<float> channels;
    for (std::uint64_t i = 0; i < used.size(); ++i) {
      const std::uint32_t vertex = vertices.at(i);
      const GltfTransform transform = place(vertex);
      append_position(positions, vertex, transform);
      channels.clear();
      for (const AttributePart& part : parts) {
        if (part.count > 0)
          add_attribute(part, all, vertex, transform, channels);
      }
      import_.zeroed += mesh_io::zero_what_is_not_finite(parts, channels);
      mesh_.attributes.append(channels);
    }
  }

  void count_filled(Attributes& all, std::uint64_t vertices) {
    for (const AttributePart& part : import_.layout.parts())
      without_[static_cast<std::size_t>(part.kind)] +=
          part.count > 0 && !all.of(part.kind) ? vertices : 0;
  }

  void append_position(GltfElements& positions, std::uint32_t vertex,
                       const GltfTransform& transform) {
    const std::span<const double> at = positions.at(vertex);
    Vec3d p{at[0], at[1], at[2]};
    if (transform != GltfTransform{})
      p = mesh_io::transformed(transform, p);
    for (const double coordinate : {p.x, p.y, p.z}) {
      if (!mesh_io::is_coordinate(coordinate))
        fail_at(positions, vertex, coordinate, mesh_io::kCoordinateRange);
    }
    import_.fits_float = import_.fits_float && fits_float(p);
    mesh_.positions.append(p);
  }

  [[noreturn]] void fail_at(const GltfElements& elements, std::uint32_t vertex, double value,
                            std::string_view expected) const {
    file_.fail(fmt::format("{}: element {} has {}, expected {}", elements.source().name, vertex,
                           value, expected));
  }

  /// Finite as a float.
  float checked(const GltfElements& elements, std::uint32_t vertex, double value) const {
    const auto number = static_cast<float>(value);
    if (!std::isfinite(number))
      fail_at(elements, vertex, value, "a finite number");
    return number;
  }

  void add_attribute(const AttributePart& part, Attributes& all, std::uint32_t vertex,
                     const GltfTransform& transform, std::vector<float>& channels) const {
    switch (part.kind) {
      case AttributeKind::normals:
        return add_normal(all.of(part.kind), vertex, transform, channels);
      case AttributeKind::colours:
        return add_colour(part, all, vertex, channels);
      case AttributeKind::values:
        return add_values(all, vertex, channels);
      case AttributeKind::texcoords:
        return add_texcoord(all, vertex, channels);
      case AttributeKind::material:
        return channels.push_back(all.material);
    }
  }

  static void add_normal(std::optional<GltfElements>& normals, std::uint32_t vertex,
                         const GltfTransform& transform, std::vector<float>& channels) {
    Vec3d normal;
    if (normals) {
      const std::span<const double> n = normals->at(vertex);
      const Vec3d given{n[0], n[1], n[2]};
      normal = std::ranges::all_of(n, [](double number) { return std::isfinite(number); })
                   ? turned_normal(given, transform)
                   : given;
    }
    channels.insert(channels.end(), {static_cast<float>(normal.x), static_cast<float>(normal.y),
                                     static_cast<float>(normal.z)});
  }

  static Vec3d turned_normal(Vec3d normal, const GltfTransform& transform) {
    if (transform.rows == GltfTransform{}.rows)
      return normal;
    const std::array<Vec3d, 3> rows = normal_rows(transform);
    const Vec3d n{dot(rows[0], normal), dot(rows[1], normal), dot(rows[2], normal)};
    const double size = length(n);
    return std::isfinite(size) && size > 0 ? n * (1 / size) : Vec3d{};
  }

  void add_colour(const AttributePart& part, Attributes& all, std::uint32_t vertex,
                  std::vector<float>& channels) const {
    auto& colours = all.of(part.kind);
    if (colours && !all.is_untinted) {
      for (const double value : colours->at(vertex)) {
        if (channels.size() < part.end())
          channels.push_back(checked(*colours, vertex, value) * (widens_colours_ ? 257 : 1));
      }
    }
    channels.resize(part.end(), full_number(import_.layout.colour));
    if (all.factor != std::array<double, 4>{1, 1, 1, 1} || all.light != std::array<double, 3>{})
      show_through(part.of(std::span(channels)), all);
  }

  void add_values(Attributes& all, std::uint32_t vertex, std::vector<float>& channels) const {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const ValueType type = values_[i].attribute.type;
      const double value = all.values[i] ? all.values[i]->at(vertex)[values_[i].component]
                                         : std::numeric_limits<double>::quiet_NaN();
      append_value(type, value, channels);
    }
  }

  /// Changes a colour by the material's factor and light. Whole numbers stay whole.
  void show_through(std::span<float> colour, const Attributes& all) const {
    const bool is_whole = import_.layout.colour != ColourType::f32;
    const double most = full_number(import_.layout.colour);
    for (std::size_t c = 0; c < colour.size(); ++c) {
      double shown = double{colour[c]} * all.factor[c];
      if (c < all.light.size() && all.light[c] > 0)
        shown = std::min(shown + all.light[c] * most, most);
      colour[c] = static_cast<float>(is_whole ? std::round(shown) : shown);
    }
  }

  static void add_texcoord(Attributes& all, std::uint32_t vertex, std::vector<float>& channels) {
    std::array<double, 2> uv{};
    if (auto& texcoords = all.of(AttributeKind::texcoords)) {
      std::ranges::copy(texcoords->at(vertex), uv.begin());
      if (all.texture != nullptr && *all.texture != mesh_io::GltfTextureTransform{})
        uv = transformed(*all.texture, uv[0], uv[1]);
    }
    channels.insert(channels.end(), {static_cast<float>(uv[0]), static_cast<float>(uv[1])});
  }

  std::uint64_t without(AttributeKind kind) const {
    return without_[static_cast<std::size_t>(kind)];
  }

  GltfImport finish() {
    import_.counts = {{"ignored_animations", file_.document().animations},
                      {"ignored_cameras", scene_.cameras},
                      {std::string(kPointsAndLines), ignored_primitives_},
                      {std::string(kInvisibleParts), invisible_},
                      {std::string(kMadeOpaque), is_textured() ? 0 : materials_.translucent()},
                      {std::string(kIgnoredTechniques), materials_.unknown()},
                      {"skinned_meshes", skinned_},
                      {"ignored_morph_targets", morph_targets_},
                      {"repeated_meshes", repeated_},
                      {"instanced_meshes", copies_},
                      {"hidden_meshes", scene_.hidden},
                      {"ignored_skins", ignored_skins_},
                      {std::string(kIgnoredEmission), materials_.dropped_lights(is_textured())},
                      {"dropped_values", found_values_.dropped()},
                      {"vertices_left_out", left_out_},
                      {"vertices_without_normal", without(AttributeKind::normals)},
                      {"vertices_without_texcoord", without(AttributeKind::texcoords)}};
    std::ranges::move(source_counts(objects_.unread()), std::back_inserter(import_.counts));
    return std::move(import_);
  }

  GltfFile& file_;
  RawMesh& mesh_;
  Textures textures_;
  const ImportRoom& room_;
  mesh_io::GltfScene scene_;
  GltfObjects objects_;
  GltfMaterials materials_;
  GltfImport import_;
  GltfValues found_values_;
  std::vector<GltfValue> values_;  ///< values of import_.layout
  bool widens_colours_ = false;    ///< from 8 bits to 16
  std::uint64_t copies_ = 0;       ///< copies by EXT_mesh_gpu_instancing
  std::map<std::uint32_t, std::vector<GltfTransform>> skins_;
  std::uint64_t skinned_ = 0, ignored_skins_ = 0, invisible_ = 0;
  std::uint64_t repeated_ = 0, morph_targets_ = 0, ignored_primitives_ = 0, left_out_ = 0;
  std::array<std::uint64_t, kAttributeKindCount> without_{};  ///< vertices, of each kind
};

}  // namespace

GltfImport import_gltf(mesh_io::GltfFile& file, const GltfPlace& place, RawMesh& mesh,
                       Textures textures, const mesh_io::AttributeChoice& attributes,
                       const ImportRoom& room) {
  return GltfImporter(file, place, mesh, textures, attributes, room).run();
}

}  // namespace meshhier::importing
