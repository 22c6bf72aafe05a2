#include "mesh_io/gltf_draco.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "mesh_io/draco_numbers.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <optional>
#include <utility>

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

// The memory that the decoder takes for each triangle (its corners, their neighbours, two visits,
// the stream's symbols), and for a point beside its attributes (corner, place in each attribute's
// values).
constexpr std::uint64_t kTriangleBytes = 128;
constexpr std::uint64_t kPointBytes = 48;
constexpr std::uint64_t kDecodedBytes = std::uint64_t{1} << 16;

// Draco bitstream specification, sections 4 (header) and 6 (connectivity), little endian.
constexpr std::string_view kDracoMagic = "DRACO";
constexpr std::uint16_t kDracoVersion = 0x0202;  // the one of the extension
constexpr std::uint16_t kHasMetadata = 0x8000;
constexpr std::uint8_t kMesh = 1;
constexpr std::uint8_t kEdgebreaker = 1;

struct DracoHead {
  std::uint64_t triangles = 0, points = 0;
  bool is_edgebreaker = false;
};

/// Reads counts and method in the stream's head, before the library believes them; nothing if it is
/// no mesh.
std::optional<DracoHead> read_head(std::span<const std::byte> stream) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(stream.data()), stream.size(), kDracoVersion);
  std::array<char, kDracoMagic.size()> magic{};
  std::uint8_t major = 0, minor = 0, type = 0, method = 0, traversal = 0;
  std::uint16_t flags = 0;
  if (!buffer.Decode(magic.data(), magic.size()) || !buffer.Decode(&major) ||
      !buffer.Decode(&minor) || !buffer.Decode(&type) || !buffer.Decode(&method) ||
      !buffer.Decode(&flags) || std::string_view(magic.data(), magic.size()) != kDracoMagic ||
      (major << 8 | minor) != kDracoVersion || type != kMesh || method > kEdgebreaker)
    return std::nullopt;
  if ((flags & kHasMetadata) != 0) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata))
      return std::nullopt;
  }
  if (method == kEdgebreaker && !buffer.Decode(&traversal))
    return std::nullopt;
  std::uint32_t first = 0, second = 0;
  if (!draco::DecodeVarint(&first, &buffer) || !draco::DecodeVarint(&second, &buffer))
    return std::nullopt;
  return method == kEdgebreaker ? DracoHead{second, first, true} : DracoHead{first, second};
}

std::unique_ptr<draco::MeshDecoder> decoder_for(const DracoHead& head) {
  if (head.is_edgebreaker)
    return std::make_unique<draco::MeshEdgebreakerDecoder>();
  return std::make_unique<draco::MeshSequentialDecoder>();
}

/// One primitive's decoding.
class Decoding {
 public:
  Decoding(GltfFile& file, const GltfPrimitive& primitive)
      : file_(file),
        primitive_(primitive),
        name_(fmt::format("bufferViews[{}]", primitive.draco->view)) {}

  GltfDracoMesh run() {
    const GltfRange range = file_.view(primitive_.draco->view);
    file_.require_memory(range.size, name_);
    file_.room().check();
    std::vector<std::byte> stream(range.size);
    range.read(0, stream);
    decode(stream, check_head(stream));
    take_indices();
    for (const auto& [name, id] : primitive_.draco->ids) {
      if (primitive_.attribute(name))
        take_attribute(name, id);
    }
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    file_.fail(name_ + ": its Draco stream " + message);
  }

  std::uint64_t point_bytes() const {
    std::uint64_t bytes = kPointBytes;
    for (const auto& [name, accessor] : primitive_.attributes)
      bytes += 2 * file_.document().accessors[accessor].element_bytes();
    return bytes;
  }

  DracoHead check_head(std::span<const std::byte> stream) {
    const auto head = read_head(stream);
    if (!head)
      fail("is no mesh of Draco's version 2.2");
    const auto position = primitive_.attribute("POSITION");
    most_points_ = head->points;
    if (position)
      most_points_ = std::max(most_points_, file_.document().accessors[*position].count);
    if (head->triangles > file_.room().memory_bytes || most_points_ > file_.room().memory_bytes)
      file_.require_memory(std::max(head->triangles, most_points_), name_);
    taken_ = file_.take_memory(
        stream.size() + head->triangles * kTriangleBytes + most_points_ * point_bytes(), name_);
    return *head;
  }

  void decode(std::span<const std::byte> stream, const DracoHead& head) {
    const std::unique_ptr<draco::MeshDecoder> decoder = decoder_for(head);
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(stream.data()), stream.size());
    mesh_ = std::make_unique<draco::Mesh>();
    try {
      const draco::Status status = decoder->Decode({}, &buffer, mesh_.get());
      if (!status.ok())
        fail("is broken: " + plain_text(status.error_msg_string(), 100));
      for (int i = 0; i < mesh_->num_attributes(); ++i)
        compute_floats(decoder->GetPortableAttribute(i), *mesh_->attribute(i));
    } catch (const Error&) {
      throw;
    } catch (const std::exception&) {  // sizes that it believed
      fail("is broken");
    }
    if (mesh_->num_points() > most_points_)
      fail(fmt::format("has {} points, more than its accessors say ({})", mesh_->num_points(),
                       most_points_));
  }

  GltfSpoolBytes& add_bytes() {
    result_.bytes.push_back(std::make_unique<GltfSpoolBytes>(file_.room().scratch));
    return *result_.bytes.back();
  }

  void append(GltfSpoolBytes& to, std::vector<std::byte>& block, std::span<const std::byte> more) {
    block.insert(block.end(), more.begin(), more.end());
    if (block.size() < kDecodedBytes)
      return;
    file_.room().check();
    to.append(block);
    block.clear();
  }

  void take_indices() {
    GltfSpoolBytes& bytes = add_bytes();
    std::vector<std::byte> block;
    std::array<std::byte, 4> corner{};
    for (draco::FaceIndex f(0); f < mesh_->num_faces(); ++f) {
      for (const draco::PointIndex& point : mesh_->face(f)) {
        storage::store_little(point.value(), corner.data());
        append(bytes, block, corner);
      }
    }
    bytes.append(block);
    result_.indices = {.name = name_ + ".indices",
                       .range = GltfRange{&bytes, 0, bytes.size()},
                       .stride = 4,
                       .count = std::uint64_t{3} * mesh_->num_faces(),
                       .component = GltfComponent::u32};
  }

  template <class Stored>
  bool take_values(const draco::PointAttribute& attribute, std::uint32_t components,
                   GltfSpoolBytes& bytes) {
    std::vector<std::byte> block;
    std::array<Stored, GltfElements::kMostComponents> element{};
    std::array<std::byte, sizeof element> little{};
    for (draco::PointIndex point(0); point < mesh_->num_points(); ++point) {
      const draco::AttributeValueIndex value = attribute.mapped_index(point);
      if (value.value() >= attribute.size() ||
          !attribute.ConvertValue(value, static_cast<std::int8_t>(components), element.data()))
        return false;
      for (std::size_t i = 0; i < components; ++i)
        store(element[i], little.data() + i * sizeof(Stored));
      append(bytes, block, std::span(little).first(components * sizeof(Stored)));
    }
    bytes.append(block);
    return true;
  }

  template <class Stored>
  static void store(Stored value, std::byte* to) {
    if constexpr (std::is_same_v<Stored, float>)
      storage::store_little(value, to);
    else
      storage::store_little(static_cast<std::make_unsigned_t<Stored>>(value), to);
  }

  bool take_values_as(GltfComponent component, const draco::PointAttribute& attribute,
                      std::uint32_t components, GltfSpoolBytes& bytes) {
    switch (component) {
      case GltfComponent::i8:
        return take_values<std::int8_t>(attribute, components, bytes);
      case GltfComponent::u8:
        return take_values<std::uint8_t>(attribute, components, bytes);
      case GltfComponent::i16:
        return take_values<std::int16_t>(attribute, components, bytes);
      case GltfComponent::u16:
        return take_values<std::uint16_t>(attribute, components, bytes);
      case GltfComponent::u32:
        return take_values<std::uint32_t>(attribute, components, bytes);
      case GltfComponent::f32:
        return take_values<float>(attribute, components, bytes);
    }
    return false;
  }

  void take_attribute(const std::string& name, std::uint32_t id) {
    const std::uint32_t number = *primitive_.attribute(name);
    const GltfAccessor& accessor = file_.document().accessors[number];
    const draco::PointAttribute* attribute = mesh_->GetAttributeByUniqueId(id);
    if (attribute == nullptr)
      fail(fmt::format("has no attribute {} for {}", id, name));
    if (static_cast<std::uint32_t>(attribute->num_components()) != accessor.components)
      fail(fmt::format("has {} components of {}, expected {}", attribute->num_components(), name,
                       accessor.components));
    GltfSpoolBytes& bytes = add_bytes();
    if (!take_values_as(accessor.component, *attribute, accessor.components, bytes))
      fail("has values that are none of " + name);
    result_.attributes[name] = {.name = fmt::format("accessors[{}]", number),
                                .range = GltfRange{&bytes, 0, bytes.size()},
                                .stride = accessor.element_bytes(),
                                .count = mesh_->num_points(),
                                .component = accessor.component,
                                .components = accessor.components,
                                .normalized = accessor.normalized};
  }

  GltfFile& file_;
  const GltfPrimitive& primitive_;
  std::string name_;
  std::uint64_t most_points_ = 0;
  std::shared_ptr<const void> taken_;  ///< memory, until all is taken out of the mesh
  std::unique_ptr<draco::Mesh> mesh_;
  GltfDracoMesh result_;
};

}  // namespace

GltfDracoMesh decode_draco(GltfFile& file, const GltfPrimitive& primitive) {
  return Decoding(file, primitive).run();
}

}  // namespace meshhier::mesh_io
