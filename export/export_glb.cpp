// A cut as one GLB. Its JSON comes first and names the size of everything, so parts are read twice:
// for their sizes, then for their bytes. The JSON is made twice too, and never held as a whole.
#include "base/bounds.h"
#include "base/error.h"
#include "base/plain_text.h"
#include "export/byte_stream.h"
#include "export/export_parts.h"
#include "export/glb_objects.h"
#include "storage/format/glb.h"
#include "storage/format/glb_material.h"
#include "storage/format/showable.h"
#include "storage/format/tile_colours.h"
#include "storage/format/tile_plan.h"
#include "storage/format/tile_values.h"
#include "storage/io/json_text.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::exporting {
namespace {

using Json = nlohmann::ordered_json;

/// The facts that are kept of each part.
struct PartFacts {
  std::uint32_t vertices = 0, triangles = 0, image_bytes = 0;
  std::uint32_t objects = 0;  ///< different ones; 0: the mesh has none
  ImageFormat format{};
  AlphaMode alpha{};
  Bounds bounds;
};

PartFacts facts_of(const CutPart& part) {
  return {static_cast<std::uint32_t>(part.vertices.size()),
          static_cast<std::uint32_t>(part.triangles.size()),
          static_cast<std::uint32_t>(part.image.bytes.size()),
          0,
          part.image.format,
          part.image.alpha,
          bounds_of(part.vertices.positions)};
}

/// A run of bytes, a buffer view of its own; an accessor unless it is the picture.
struct GlbSection {
  std::string_view attribute;  ///< empty: indices or picture
  std::string_view type;       ///< empty: the picture
  unsigned component = 0;
  std::uint64_t count = 0, stride = 0;
  bool normalized = false;

  std::uint64_t bytes() const { return count * stride; }
};

constexpr std::size_t kPositions = 0;
constexpr std::size_t kFirstAttribute = 1;
constexpr std::size_t kFeatures = kFirstAttribute + storage::kAttributeSections.size();
constexpr std::size_t kIndices = kFeatures + 1;
constexpr std::size_t kPicture = kIndices + 1;
using GlbSections = std::array<GlbSection, kPicture + 1>;

/// The sections of the parts.
class GlbLayout {
 public:
  /// `rows`: of the table of objects; 0: there is none.
  GlbLayout(const storage::TileFormat& format, std::uint32_t rows) : format_(format), rows_(rows) {}

  /// Returns positions, normals, colours, texture coordinates, rows of objects, indices, picture;
  /// those that are not
  /// there have no bytes.
  GlbSections sections(const PartFacts& part) const {
    const AttributeLayout& layout = format_.attributes;
    const std::uint64_t n = part.vertices;
    GlbSections sections;
    sections[kPositions] = {"POSITION", "VEC3", storage::kF32, n, 12};
    const storage::ChannelGroups groups = storage::groups_of(layout);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const unsigned component =
          storage::component_of(groups[i].kind, storage::TileColours(layout, false));
      const std::size_t channels = is_made(groups[i].kind, part)
                                       ? static_cast<std::size_t>(row_of(groups[i].kind).size)
                                       : groups[i].channels;
      sections[kFirstAttribute + i] = {
          groups[i].kind == AttributeKind::colours
              ? storage::colour_attribute(layout, format_.textures.has_value())
              : row_of(groups[i].kind).gltf,
          storage::vector_type(channels),
          component,
          channels > 0 ? n : 0,
          storage::aligned4(channels * storage::component_bytes(component)),
          component != storage::kF32};
    }
    const bool has_short_rows = rows_ <= UINT16_MAX;
    sections[kFeatures] = {storage::kFeatureAttribute, "SCALAR",
                           has_short_rows ? storage::kU16 : storage::kF32, rows_ > 0 ? n : 0, 4};
    sections[kIndices] = {"", "SCALAR", index_component(n), 3 * std::uint64_t{part.triangles},
                          storage::component_bytes(index_component(n))};
    sections[kPicture] = {"", "", 0, part.image_bytes, 1};
    return sections;
  }

  std::uint64_t bytes(const PartFacts& part) const {
    std::uint64_t sum = 0;
    for (const GlbSection& section : sections(part))
      sum += storage::aligned4(section.bytes());
    return sum;
  }

 private:
  /// Whether tiles have it although the input had not.
  bool is_made(AttributeKind kind, const PartFacts& part) const {
    return (kind == AttributeKind::normals && format_.computed_normals) ||
           (kind == AttributeKind::texcoords && part.image_bytes > 0);
  }
  static unsigned index_component(std::uint64_t vertices) {
    return vertices <= storage::kMaxShortVertices ? storage::kU16 : storage::kU32;
  }

  const storage::TileFormat& format_;
  std::uint32_t rows_;
};

/// The JSON, piece by piece.
class GlbText {
 public:
  /// `objects`: null if there are none.
  GlbText(const storage::TileFormat& format, std::span<const PartFacts> parts,
          const GlbObjects* objects)
      : format_(format),
        layout_(format, objects != nullptr ? objects->rows() : 0),
        parts_(parts),
        objects_(objects) {}

  using Sink = std::function<void(std::string_view)>;

  void write(const Sink& sink) const {
    Json head;
    head["asset"] = {{"version", "2.0"}, {"generator", "meshhier"}};
    add_extensions(head);
    head["scene"] = 0;
    head["scenes"] = Json::array({Json::object({{"nodes", Json::array({0})}})});
    head["nodes"] = Json::array({storage::mesh_node(format_.frame)});
    if (objects_ != nullptr)
      head["extensions"][storage::kMetadataExtension] = objects_->metadata(section_count());
    std::string text = storage::json_text(head);
    text.pop_back();
    sink(text);
    sink(",\"meshes\":[{");
    write_array(sink, "primitives", &GlbText::primitives);
    sink("}],");
    write_array(sink, "materials", &GlbText::materials);
    if (has_pictures()) {
      sink(",\"samplers\":" + storage::json_text(Json::array({storage::sampler_json()})) + ",");
      write_array(sink, "textures", &GlbText::textures);
      sink(",");
      write_array(sink, "images", &GlbText::images);
    }
    sink(",");
    write_array(sink, "accessors", &GlbText::accessors);
    sink(",");
    write_array(sink, "bufferViews", &GlbText::views);
    sink(fmt::format(",\"buffers\":[{{\"byteLength\":{}}}]}}", bin_bytes()));
  }

  std::uint64_t bin_bytes() const {
    return objects_ != nullptr ? table_offset() + objects_->columns().bytes : part_bytes();
  }
  /// Returns how many bytes there are between the parts and the table of objects.
  std::uint64_t table_padding() const { return table_offset() - part_bytes(); }

 private:
  using Item = std::function<void(const Json&)>;

  std::uint64_t part_bytes() const {
    std::uint64_t sum = 0;
    for (const PartFacts& part : parts_)
      sum += layout_.bytes(part);
    return sum;
  }
  std::uint64_t table_offset() const { return (part_bytes() + 7) / 8 * 8; }

  std::size_t section_count() const {
    std::size_t count = 0;
    each_section([&](std::size_t, std::uint64_t, const PartFacts&, const GlbSection&) { ++count; });
    return count;
  }

  bool has_pictures() const { return format_.textures.has_value(); }

  void add_extensions(Json& document) const {
    const char* const required =
        has_pictures() ? row_of(format_.textures->format).gltf_extension : nullptr;
    Json used = Json::array();
    if (has_pictures() && format_.textures->unlit)
      used.push_back(storage::kUnlitExtension);
    if (objects_ != nullptr) {
      used.push_back(storage::kFeaturesExtension);
      used.push_back(storage::kMetadataExtension);
    }
    if (required != nullptr) {
      used.push_back(required);
      document["extensionsRequired"] = Json::array({required});
    }
    if (!used.empty())
      document["extensionsUsed"] = used;
  }

  void write_array(const Sink& sink, const char* name,
                   void (GlbText::*items)(const Item&) const) const {
    sink(fmt::format("\"{}\":[", name));
    const char* separator = "";
    (this->*items)(
        [&](const Json& item) { sink(std::exchange(separator, ",") + storage::json_text(item)); });
    sink("]");
  }

  void primitives(const Item& item) const {
    std::size_t accessor = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      Json primitive;
      for (const GlbSection& section : layout_.sections(parts_[i])) {
        if (section.count == 0 || section.type.empty())
          continue;
        if (!section.attribute.empty())
          primitive["attributes"][std::string(section.attribute)] = accessor++;
        else
          primitive["indices"] = accessor++;
      }
      primitive["material"] = has_pictures() ? i : 0;
      if (objects_ != nullptr)
        primitive["extensions"][storage::kFeaturesExtension]["featureIds"] = Json::array(
            {{{"featureCount", parts_[i].objects}, {"attribute", 0}, {"propertyTable", 0}}});
      item(primitive);
    }
  }

  void materials(const Item& item) const {
    if (!has_pictures())
      return item(storage::material_json());
    for (std::size_t i = 0; i < parts_.size(); ++i)
      item(storage::material_json(i, parts_[i].alpha, format_.textures->unlit));
  }

  void textures(const Item& item) const {
    for (std::size_t i = 0; i < parts_.size(); ++i)
      item(storage::texture_json(i, parts_[i].format));
  }

  void images(const Item& item) const {
    each_section(
        [&](std::size_t view, std::uint64_t, const PartFacts& part, const GlbSection& section) {
          if (section.type.empty())
            item(storage::image_json(view, part.format));
        });
  }

  void accessors(const Item& item) const {
    each_section(
        [&](std::size_t view, std::uint64_t, const PartFacts& part, const GlbSection& section) {
          if (section.type.empty())
            return;
          Json accessor = {{"bufferView", view},
                           {"componentType", section.component},
                           {"count", section.count},
                           {"type", section.type}};
          if (section.normalized)
            accessor["normalized"] = true;
          if (section.attribute == "POSITION") {
            const Vec3d min = to_double(part.bounds.min), max = to_double(part.bounds.max);
            accessor["min"] = {min.x, min.y, min.z};
            accessor["max"] = {max.x, max.y, max.z};
          }
          item(accessor);
        });
  }

  void views(const Item& item) const {
    each_section(
        [&](std::size_t, std::uint64_t offset, const PartFacts&, const GlbSection& section) {
          Json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", section.bytes()}};
          if (!section.attribute.empty()) {
            view["byteStride"] = section.stride;
            view["target"] = storage::kVertexTarget;
          } else if (!section.type.empty()) {
            view["target"] = storage::kIndexTarget;
          }
          item(view);
        });
    if (objects_ != nullptr)
      column_views(item);
  }

  void column_views(const Item& item) const {
    const auto add = [&](std::uint64_t offset, std::uint64_t bytes) {
      item(Json{{"buffer", 0}, {"byteOffset", table_offset() + offset}, {"byteLength", bytes}});
    };
    for (const storage::ObjectColumn& column : objects_->columns().columns) {
      add(column.values, std::max<std::uint64_t>(column.value_bytes, 1));
      if (column.start_bytes > 0)
        add(column.starts, column.start_bytes);
    }
  }

  /// Calls visit(number, offset, part, section) for sections that have bytes.
  template <class Visit>
  void each_section(const Visit& visit) const {
    std::size_t view = 0;
    std::uint64_t offset = 0;
    for (const PartFacts& part : parts_) {
      for (const GlbSection& section : layout_.sections(part)) {
        if (section.count == 0)
          continue;
        visit(view++, offset, part, section);
        offset += storage::aligned4(section.bytes());
      }
    }
  }

  const storage::TileFormat& format_;
  GlbLayout layout_;
  std::span<const PartFacts> parts_;
  const GlbObjects* objects_;
};

/// The sections of one part.
class PartBytes {
 public:
  PartBytes(const storage::TileFormat& format, const CutPart& part, const GlbObjects* objects)
      : layout_(format.attributes),
        part_(part),
        objects_(objects),
        colours_(layout_, false),
        shown_(colours_.all_stored(storage::showable_attributes(layout_, part.vertices))),
        sections_(
            GlbLayout(format, objects != nullptr ? objects->rows() : 0).sections(facts_of(part))) {}

  void write(ByteStream& to) {
    put(to, kPositions, [&](std::size_t v) { append(part_.vertices.positions[v]); });
    const storage::ChannelGroups groups = storage::groups_of(layout_);
    for (std::size_t i = 0; i < groups.size(); ++i)
      put(to, kFirstAttribute + i, [&](std::size_t v) { append_attribute(groups[i], v); });
    put(to, kFeatures, [&](std::size_t v) { append_row(v); });
    put(to, kIndices, [&](std::size_t i) { append_index(part_.triangles[i / 3][i % 3]); });
    bytes_ = part_.image.bytes;
    pad_and_put(to);
  }

 private:
  template <class Append>
  void put(ByteStream& to, std::size_t section, const Append& append) {
    for (std::size_t i = 0; i < sections_[section].count; ++i)
      append(i);
    pad_and_put(to);
  }

  void pad_and_put(ByteStream& to) {
    bytes_.resize(storage::aligned4(bytes_.size()));
    to.put(bytes_);
    bytes_.clear();
  }

  void append(const Vec3f& p) {
    for (const float value : {p.x, p.y, p.z})
      storage::append_little(bytes_, value);
  }

  /// Normals and coordinates that the build made come before those of the input.
  void append_attribute(const storage::ChannelGroup& group, std::size_t vertex) {
    if (group.kind == AttributeKind::normals && !part_.normals.empty())
      return append(part_.normals[vertex]);
    if (group.kind == AttributeKind::texcoords && !part_.texcoords.empty()) {
      storage::append_little(bytes_, part_.texcoords[vertex].u);
      return storage::append_little(bytes_, part_.texcoords[vertex].v);
    }
    const auto all = static_cast<std::size_t>(layout_.channels());
    const unsigned component = storage::component_of(group.kind, colours_);
    for (const float value :
         std::span(shown_).subspan(vertex * all + group.offset, group.channels)) {
      if (component == storage::kU8)
        storage::append_little(bytes_, static_cast<std::uint8_t>(value));
      else if (component == storage::kU16)
        storage::append_little(bytes_, static_cast<std::uint16_t>(value));
      else
        storage::append_little(bytes_, value);
    }
    bytes_.resize(storage::aligned4(bytes_.size()));
  }

  void append_row(std::size_t vertex) {
    const std::uint32_t row = objects_->row_of(part_.vertices.attributes_of(vertex));
    if (sections_[kFeatures].component == storage::kU16)
      storage::append_little(bytes_, row);  // the upper half is the gap between two
    else
      storage::append_little(bytes_, static_cast<float>(row));
  }

  void append_index(std::uint32_t vertex) {
    if (sections_[kIndices].component == storage::kU16)
      storage::append_little(bytes_, static_cast<std::uint16_t>(vertex));
    else
      storage::append_little(bytes_, vertex);
  }

  const AttributeLayout& layout_;
  const CutPart& part_;
  const GlbObjects* objects_;
  storage::TileColours colours_;
  std::vector<float> shown_;  ///< as the sections hold them
  GlbSections sections_;
  std::vector<std::byte> bytes_;
};

void put_chunk_head(ByteStream& to, std::uint64_t bytes, std::string_view type) {
  std::vector<std::byte> length;
  storage::append_little(length, static_cast<std::uint32_t>(bytes));
  to.put(length);
  to.put(type);
}

/// What a first look at all parts tells.
struct GlbContent {
  std::vector<std::size_t> shown;  ///< parts that draw something
  std::vector<PartFacts> facts;    ///< of these
  std::uint64_t vertices = 0, triangles = 0;
};

/// Throws Error(usage) if no part draws anything. Adds the parts' objects.
GlbContent look_at(const PartsJob& job, const ExportedParts& parts, GlbObjects* objects) {
  GlbContent content;
  for (std::size_t i = 0; i < parts.count; ++i) {
    job.cancel.check();
    const CutPart loaded = parts.load(i);
    PartFacts part = facts_of(loaded);
    if (part.triangles > 0) {
      part.objects = objects != nullptr ? objects->add(loaded) : 0;
      content.facts.push_back(part);
      content.shown.push_back(i);
    }
    content.vertices += part.vertices;
    content.triangles += part.triangles;
    job.progress.advance(1);
  }
  if (content.shown.empty())
    throw Error(ErrorCode::usage, "there are no triangles to export: a GLB shows nothing else");
  return content;
}

/// Writes all that stands before the parts. Throws Error(usage) if the file would be too large.
void put_head(ByteStream& to, const GlbText& text) {
  std::uint64_t json_bytes = 0;
  text.write([&](std::string_view piece) { json_bytes += piece.size(); });
  const std::uint64_t all = storage::glb_bytes(json_bytes, text.bin_bytes());
  if (all > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(
        ErrorCode::usage,
        fmt::format("this would be a GLB of {} bytes, but none has 4 GiB: export an OBJ, or "
                    "a coarser level",
                    all));
  }
  to.put("glTF");
  put_chunk_head(to, 2, std::string_view());
  put_chunk_head(to, all, std::string_view());
  put_chunk_head(to, storage::aligned4(json_bytes), "JSON");
  text.write([&](std::string_view piece) { to.put(piece); });
  to.put(std::string(storage::aligned4(json_bytes) - json_bytes, ' '));
  put_chunk_head(to, text.bin_bytes(), std::string_view("BIN\0", 4));
}

}  // namespace

std::string write_glb(const PartsJob& job, const ExportedParts& parts) {
  job.progress.stage("export", 2 * parts.count, "tiles");
  storage::TileFormat format = job.reader.tile_format();
  format.frame.origin = job.reader.manifest().origin;  // no tileset is around it
  std::optional<GlbObjects> objects;
  if (job.reader.manifest().objects)
    objects.emplace(job);
  GlbObjects* const table = objects ? &*objects : nullptr;
  const GlbContent content = look_at(job, parts, table);
  if (table != nullptr)
    table->make_table();
  const GlbText text(format, content.facts, table);
  ByteStream out(*job.output.file());
  put_head(out, text);
  for (const std::size_t i : content.shown) {
    job.cancel.check();
    PartBytes(format, parts.load(i), table).write(out);
    job.progress.advance(1);
  }
  if (table != nullptr) {
    out.put(std::vector<std::byte>(text.table_padding()));
    table->write(out);
  }
  job.progress.advance(parts.count - content.shown.size());
  out.flush();
  job.output.publish();
  return fmt::format("{}, {}{}", counted(content.vertices, "vertices"),
                     counted(content.triangles, "triangles"),
                     format.textures ? ", " + counted(content.shown.size(), "pictures") : "");
}

}  // namespace meshhier::exporting
