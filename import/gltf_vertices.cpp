#include "import/gltf_vertices.h"

#include "base/angle.h"
#include "execution/spool_cursor.h"
#include "import/append_value.h"
#include "mesh_io/coordinate_range.h"
#include "mesh_io/zeroed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using mesh_io::GltfElements;
using mesh_io::GltfElementSource;
using mesh_io::GltfPrimitive;
using mesh_io::GltfTransform;

/// A texture coordinate of the picture; rotations are counter-clockwise with v pointing down, as
/// viewers have them.
std::array<double, 2> transformed(const mesh_io::GltfTextureTransform& t, double u, double v) {
  const UnitTurn turn = turn_by(std::remainder(t.rotation, 2 * std::numbers::pi));
  const double x = t.scale[0] * u, y = t.scale[1] * v;
  return {t.offset[0] + turn.cosine * x + turn.sine * y,
          t.offset[1] + turn.cosine * y - turn.sine * x};
}

/// The vertices of one primitive. Its attributes are those of the mesh that it has.
class PrimitiveVertices {
 public:
  PrimitiveVertices(const GltfVertexSources& from, AddedFile& added, RawMesh& mesh)
      : from_(from),
        file_(from.primitive.file()),
        primitive_(from.primitive.primitive()),
        added_(added),
        mesh_(mesh) {
    open_attributes();
    if (added.material_colours > 0)
      take_colour();
    if (added.layout.material)
      take_material();
  }

  void append(const References& used, const GltfVertexPlace& place, const ImportRoom& room) {
    count_filled(used.size());
    GltfElements positions(file_, from_.position);
    execution::SpoolCursor vertices(used, room.cancel);
    const AttributeParts parts = added_.layout.parts();
    std::vector<float> channels;
    mesh_io::ZeroedCounts zeroed;
    for (std::uint64_t i = 0; i < used.size(); ++i) {
      const std::uint32_t vertex = vertices.at(i);
      const GltfTransform transform = place.skin ? place.skin->at(vertex) : place.transform;
      append_position(positions, vertex, transform);
      channels.clear();
      for (const AttributePart& part : parts) {
        if (part.count > 0)
          add_attribute(part, vertex, transform, channels);
      }
      zeroed += mesh_io::zero_what_is_not_finite(parts, channels);
      mesh_.attributes.append(channels);
    }
    added_.count(zeroed);
  }

 private:
  void open_attributes() {
    const AttributeLayout& layout = added_.layout;
    const std::string texcoords = from_.materials.texcoords(primitive_.material);
    for (const AttributePart& part : layout.parts()) {
      const std::string name = gltf_name(row_of(part.kind), texcoords);
      const auto size = static_cast<std::uint32_t>(part.count);
      if (part.kind == AttributeKind::colours && size > 0)
        of(part.kind) = elements(name, 3, 4, layout.colour != ColourType::f32);
      else if (size > 0 && !name.empty())
        of(part.kind) = elements(name, size, size);
    }
    for (const GltfValue& value : from_.values)
      values_.push_back(elements(value.source, 1, 4, true));
  }

  /// Reads an attribute of as many elements as there are vertices.
  std::optional<GltfElements> elements(const std::string& name, std::uint32_t least,
                                       std::uint32_t most, bool stored = false) const {
    auto source = from_.primitive.attribute(name, least, most);
    if (!source)
      return std::nullopt;
    if (source->count != from_.position.count) {
      file_.fail(fmt::format("{} has {} elements for {}, POSITION has {}", source->name,
                             source->count, name, from_.position.count));
    }
    source->normalized = source->normalized || name == row_of(AttributeKind::colours).gltf;
    return GltfElements(
        file_, *std::move(source),
        stored ? GltfElements::Integers::stored : GltfElements::Integers::fractions);
  }

  /// Takes the material's light, or its 8-bit colour if no primitive has colours of its own.
  void take_colour() {
    if (added_.is_painted) {
      const auto [red, green, blue] = from_.materials.colour(primitive_.material).channels;
      factor_ = {red / 255.0, green / 255.0, blue / 255.0, 1};
    } else if (primitive_.material) {
      const mesh_io::GltfMaterial& material = file_.document().materials[*primitive_.material];
      std::ranges::transform(material.factor, factor_.begin(),
                             [](double part) { return std::clamp(part, 0.0, 1.0); });
      light_ = plain_light(material);
    }
  }

  void take_material() {
    const GltfLook& look = from_.materials.look(primitive_.material);
    is_untinted_ = look.is_untinted;
    material_ = static_cast<float>(from_.materials.number(primitive_.material));
    if (look.texture != nullptr)
      texture_ = look.texture->transform;
  }

  std::optional<GltfElements>& of(AttributeKind kind) {
    return given_[static_cast<std::size_t>(kind)];
  }

  void count_filled(std::uint64_t vertices) {
    if (added_.layout.normals && !of(AttributeKind::normals))
      added_.count("vertices_without_normal", vertices);
    if (added_.layout.texcoords && !of(AttributeKind::texcoords))
      added_.count("vertices_without_texcoord", vertices);
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
    added_.fits_float = added_.fits_float && fits_float(p);
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

  void add_attribute(const AttributePart& part, std::uint32_t vertex,
                     const GltfTransform& transform, std::vector<float>& channels) {
    switch (part.kind) {
      case AttributeKind::normals:
        return add_normal(vertex, transform, channels);
      case AttributeKind::colours:
        return add_colour(part, vertex, channels);
      case AttributeKind::values:
        return add_values(vertex, channels);
      case AttributeKind::texcoords:
        return add_texcoord(vertex, channels);
      case AttributeKind::material:
        return channels.push_back(material_);
    }
  }

  void add_normal(std::uint32_t vertex, const GltfTransform& transform,
                  std::vector<float>& channels) {
    Vec3d normal;
    if (auto& normals = of(AttributeKind::normals)) {
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

  void add_colour(const AttributePart& part, std::uint32_t vertex, std::vector<float>& channels) {
    auto& colours = of(part.kind);
    if (colours && !is_untinted_) {
      for (const double value : colours->at(vertex)) {
        if (channels.size() < part.end())
          channels.push_back(checked(*colours, vertex, value) * (from_.widens_colours ? 257 : 1));
      }
    }
    channels.resize(part.end(), full_number(added_.layout.colour));
    if (factor_ != std::array<double, 4>{1, 1, 1, 1} || light_ != std::array<double, 3>{})
      show_through(part.of(std::span(channels)));
  }

  void add_values(std::uint32_t vertex, std::vector<float>& channels) {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const GltfValue& value = from_.values[i];
      const double number = values_[i] ? values_[i]->at(vertex)[value.component]
                                       : std::numeric_limits<double>::quiet_NaN();
      append_value(value.attribute.type, number, channels);
    }
  }

  /// Changes a colour by the material's factor and light. Whole numbers stay whole.
  void show_through(std::span<float> colour) const {
    const bool is_whole = added_.layout.colour != ColourType::f32;
    const double most = full_number(added_.layout.colour);
    for (std::size_t c = 0; c < colour.size(); ++c) {
      double shown = double{colour[c]} * factor_[c];
      if (c < light_.size() && light_[c] > 0)
        shown = std::min(shown + light_[c] * most, most);
      colour[c] = static_cast<float>(is_whole ? std::round(shown) : shown);
    }
  }

  void add_texcoord(std::uint32_t vertex, std::vector<float>& channels) {
    std::array<double, 2> uv{};
    if (auto& texcoords = of(AttributeKind::texcoords)) {
      std::ranges::copy(texcoords->at(vertex), uv.begin());
      if (texture_ != mesh_io::GltfTextureTransform{})
        uv = transformed(texture_, uv[0], uv[1]);
    }
    channels.insert(channels.end(), {static_cast<float>(uv[0]), static_cast<float>(uv[1])});
  }

  const GltfVertexSources& from_;
  mesh_io::GltfFile& file_;
  const GltfPrimitive& primitive_;
  AddedFile& added_;
  RawMesh& mesh_;
  std::array<std::optional<GltfElements>, kAttributeKindCount> given_;  ///< but for values
  std::vector<std::optional<GltfElements>> values_;
  // The material's, if vertices have its colour.
  std::array<double, 4> factor_{1, 1, 1, 1};
  std::array<double, 3> light_{};
  bool is_untinted_ = false;  ///< the material's picture is shown as it is
  float material_ = 0;
  mesh_io::GltfTextureTransform texture_{};
};

}  // namespace

std::string gltf_name(const AttributeKindRow& row, const std::string& texcoords) {
  return row.kind == AttributeKind::texcoords ? texcoords : std::string(row.gltf);
}

void append_vertices(const GltfVertexSources& from, const References& used,
                     const GltfVertexPlace& place, AddedFile& added, RawMesh& mesh,
                     const ImportRoom& room) {
  PrimitiveVertices(from, added, mesh).append(used, place, room);
}

}  // namespace meshhier::importing
