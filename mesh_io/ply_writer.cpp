#include "mesh_io/ply_writer.h"

#include "mesh_io/ply_plan.h"
#include "mesh_io/ply_properties.h"
#include "mesh_io/ply_values.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

/// Written at once: large enough that a disk streams, as much as the contract allows.
constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

/// The largest row: three doubles and kMaxChannels floats, two of which may be one double.
constexpr std::size_t kMaxRowBytes = 3 * sizeof(double) + kMaxChannels * sizeof(float);

std::string_view colour_type_name(ColourType type) {
  return type == ColourType::u8 ? "uchar" : type == ColourType::u16 ? "ushort" : "float";
}

struct WrittenProperty {
  std::string_view type;
  std::string name;
};

/// Properties of known attributes: normals and colours stand before values, texture coordinates
/// behind them.
std::vector<WrittenProperty> known_properties(const AttributePart& part,
                                              const AttributeLayout& layout) {
  std::vector<WrittenProperty> properties;
  const auto add = [&](std::string_view type, const auto& names) {
    for (const std::string_view name : names)
      properties.push_back({type, std::string(name)});
  };
  if (part.kind == AttributeKind::colours && part.count > 0) {
    const std::string_view type = colour_type_name(layout.colour);
    add(type, imported_colour_names(layout.space, layout.tints));
    if (layout.alpha)
      add(type, std::array<std::string_view, 1>{"alpha"});
  }
  for (const PlyAttribute& attribute : kPlyAttributes) {
    if (attribute.kind == part.kind && part.count > 0)
      add("float", attribute.spelling(0));
  }
  return properties;
}

/// A value whose name another property has gets a number. `others`: all that are no values.
std::vector<WrittenProperty> value_properties(const AttributeLayout& layout, bool is_import,
                                              std::span<const WrittenProperty> others) {
  std::vector<WrittenProperty> values;
  const auto has = [](std::span<const WrittenProperty> list, const std::string& name) {
    return std::ranges::find(list, name, &WrittenProperty::name) != list.end();
  };
  for (const ScalarAttribute& value : layout.values) {
    const std::string wanted = (is_import ? imported_prefix(kind_of(value)) : "") + value.name;
    std::string name = wanted;
    for (int number = 2; has(others, name) || has(values, name); ++number)
      name = fmt::format("{}_{}", wanted, number);
    values.push_back({name_of(ply_type(value.type)), name});
  }
  return values;
}

std::string attribute_lines(const AttributeLayout& layout, bool is_import) {
  std::vector<WrittenProperty> others;
  for (const AttributePart& part : layout.parts())
    std::ranges::move(known_properties(part, layout), std::back_inserter(others));
  std::string lines;
  for (const AttributePart& part : layout.parts()) {
    for (const auto& [type, name] : part.kind == AttributeKind::values
                                        ? value_properties(layout, is_import, others)
                                        : known_properties(part, layout))
      lines += fmt::format("property {} {}\n", type, name);
  }
  return lines;
}

/// A comment must stay one line.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

std::string header_text(const PlyContent& content, std::string_view index_type) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : content.comments) {
    text += "comment " + one_line(comment) + "\n";
  }
  text += fmt::format("element vertex {}\n", content.vertex_count);
  for (const char axis : {'x', 'y', 'z'}) {
    text += fmt::format("property {} {}\n", content.double_coordinates ? "double" : "float", axis);
  }
  text += attribute_lines(content.attributes, content.is_import);
  text += fmt::format("element face {}\nproperty list uchar {} vertex_indices\n",
                      content.triangle_count, index_type);
  if (content.edge_count > 0) {
    text += fmt::format("element edge {0}\nproperty {1} vertex1\nproperty {1} vertex2\n",
                        content.edge_count, index_type);
  }
  return text + "end_header\n";
}

/// The nearest value of an unsigned type; averages of colours need not be whole.
template <class T>
T nearest(float value) {
  const float high = std::numeric_limits<T>::max();
  return static_cast<T>(std::lround(std::clamp(value, 0.0F, high)));
}

}  // namespace

struct PlyWriter::State {
  std::shared_ptr<storage::File> file;
  PlyContent content;
  std::vector<AttributePart> parts;  ///< of content.attributes, those that are there
  std::vector<std::byte> buffer;     ///< kBufferBytes
  std::size_t filled = 0;
  std::uint64_t offset = 0;
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t edges = 0;

  template <class T>
  void put(T value) {
    auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
    if constexpr (std::endian::native == std::endian::big)
      std::reverse(bytes.begin(), bytes.end());
    std::memcpy(buffer.data() + filled, bytes.data(), bytes.size());
    filled += bytes.size();
  }

  void flush() {
    file->write_at(offset, std::span(buffer).first(filled));
    offset += filled;
    filled = 0;
  }

  /// A row is never split: flushes if the largest might not fit.
  void begin_row() {
    if (filled + kMaxRowBytes > kBufferBytes)
      flush();
  }

  void put_attributes(std::span<const float> channels) {
    for (const AttributePart& part : parts) {
      if (part.kind == AttributeKind::colours)
        put_colour(part.of(channels));
      else if (part.kind == AttributeKind::values)
        put_values(part.of(channels).data());
      else
        put_floats(part.of(channels));
    }
  }

  void put_floats(std::span<const float> numbers) {
    for (const float number : numbers)
      put(number);
  }

  void put_colour(std::span<const float> colour) {
    for (const float number : colour) {
      if (content.attributes.colour == ColourType::u8)
        put(nearest<std::uint8_t>(number));
      else if (content.attributes.colour == ColourType::u16)
        put(nearest<std::uint16_t>(number));
      else
        put(number);
    }
  }

  /// `channels`: of a vertex, from the first value on.
  void put_values(const float* channels) {
    for (const ScalarAttribute& attribute : content.attributes.values) {
      const double value = of_type(attribute.type, value_in(attribute.type, channels));
      channels += channels_of(attribute.type);
      with_type(ply_type(attribute.type),
                [&](auto zero) { put(static_cast<decltype(zero)>(value)); });
    }
  }

  template <class Scalar>
  void put_vertices(std::span<const Vec3<Scalar>> positions, std::span<const float> attributes) {
    const auto channels = static_cast<std::size_t>(content.attributes.channels());
    assert(attributes.size() == positions.size() * channels);
    assert(triangles == 0 && edges == 0);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      begin_row();
      for (int axis = 0; axis < 3; ++axis) {
        if (content.double_coordinates) {
          put(static_cast<double>(positions[i][axis]));
        } else {
          put(static_cast<float>(positions[i][axis]));
        }
      }
      put_attributes(attributes.subspan(i * channels, channels));
    }
    vertices += positions.size();
  }
};

PlyWriter::PlyWriter(std::shared_ptr<storage::File> file, const PlyContent& content)
    : state_(std::make_unique<State>()) {
  state_->file = std::move(file);
  state_->content = content;
  std::ranges::copy_if(content.attributes.parts(), std::back_inserter(state_->parts),
                       [](const AttributePart& part) { return part.count > 0; });
  state_->buffer.resize(kBufferBytes);
  constexpr std::uint64_t kMaxIntVertices = std::uint64_t{1} << 31;
  const std::string header =
      header_text(content, content.vertex_count < kMaxIntVertices ? "int" : "uint");
  state_->file->write_at(0, std::as_bytes(std::span(header)));
  state_->offset = header.size();
}

PlyWriter::~PlyWriter() = default;

void PlyWriter::write_vertices(std::span<const Vec3f> positions,
                               std::span<const float> attributes) {
  state_->put_vertices(positions, attributes);
}

void PlyWriter::write_vertices(std::span<const Vec3d> positions,
                               std::span<const float> attributes) {
  state_->put_vertices(positions, attributes);
}

void PlyWriter::write_triangles(std::span<const Triangle<std::uint32_t>> triangles) {
  assert(state_->vertices == state_->content.vertex_count && state_->edges == 0);
  for (const auto& triangle : triangles) {
    state_->begin_row();
    state_->put(std::uint8_t{3});
    for (const std::uint32_t corner : triangle)
      state_->put(corner);
  }
  state_->triangles += triangles.size();
}

void PlyWriter::write_edges(std::span<const std::array<std::uint32_t, 2>> edges) {
  assert(state_->triangles == state_->content.triangle_count);
  for (const auto& edge : edges) {
    state_->begin_row();
    for (const std::uint32_t end : edge)
      state_->put(end);
  }
  state_->edges += edges.size();
}

void PlyWriter::finish() {
  assert(state_->vertices == state_->content.vertex_count);
  assert(state_->triangles == state_->content.triangle_count);
  assert(state_->edges == state_->content.edge_count);
  state_->flush();
}

}  // namespace meshhier::mesh_io
