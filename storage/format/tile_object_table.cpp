#include "storage/format/tile_object_table.h"

#include "base/error.h"
#include "hierarchy/value_channels.h"
#include "storage/format/glb.h"
#include "storage/format/metadata_ids.h"
#include "storage/format/object_table.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;
using Kind = ObjectColumn::Kind;

// What stands where an object has no value.
constexpr double kNoNumber = std::numeric_limits<double>::lowest();
constexpr std::uint8_t kNoBoolean = 255;

constexpr std::uint64_t aligned8(std::uint64_t bytes) {
  return (bytes + 7) / 8 * 8;
}

Kind kind_of(ObjectPropertyType type) {
  return type == ObjectPropertyType::number    ? Kind::number
         : type == ObjectPropertyType::boolean ? Kind::boolean
                                               : Kind::text;
}

/// The kind of a column: the object, its name, then properties.
Kind kind_of(std::span<const ObjectProperty> properties, std::size_t column) {
  return column == 0   ? Kind::object
         : column == 1 ? Kind::text
                       : kind_of(properties[column - 2].type);
}

std::uint64_t bytes_of(Kind kind) {
  return kind == Kind::object ? sizeof(std::uint32_t) : kind == Kind::number ? sizeof(double) : 1;
}

/// The first bytes of a text that make whole characters of UTF-8.
std::string_view cut(std::string_view text) {
  if (text.size() <= kMostTileTextBytes)
    return text;
  std::size_t end = kMostTileTextBytes;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U)
    --end;
  return text.substr(0, end);
}

template <Scalar T>
void append(T number, std::vector<std::byte>& to) {
  to.resize(to.size() + sizeof number);
  store_little(number, to.data() + to.size() - sizeof number);
}

void append(std::span<const std::byte> bytes, std::vector<std::byte>& to) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

void append_aligned(std::span<const std::byte> bytes, std::vector<std::byte>& to) {
  append(bytes, to);
  to.resize(aligned8(to.size()));
}

void append_text(std::string_view text, std::vector<std::byte>& to) {
  const std::string_view kept = cut(text);
  append(static_cast<std::uint8_t>(kept.size()), to);
  append(std::as_bytes(std::span(kept)), to);
}

void append_value(Kind kind, const ObjectValue& value, std::vector<std::byte>& to) {
  if (kind == Kind::text) {
    const auto* text = std::get_if<std::string>(&value);
    return append_text(text == nullptr ? std::string_view() : *text, to);
  }
  if (kind == Kind::number) {
    const auto* number = std::get_if<double>(&value);
    return append(number == nullptr ? kNoNumber : *number, to);
  }
  const auto* known = std::get_if<bool>(&value);
  append(known == nullptr ? kNoBoolean : static_cast<std::uint8_t>(*known ? 1 : 0), to);
}

void append_cells(std::span<const ObjectProperty> properties, const ObjectRow& row,
                  std::vector<std::byte>& cells) {
  append_text(row.name, cells);
  for (std::size_t i = 0; i < properties.size(); ++i)
    append_value(kind_of(properties[i].type), row.values[i], cells);
}

/// How many columns may be shown by the names that they have.
std::size_t named_columns(std::span<const ObjectProperty> properties) {
  std::size_t bytes = 0, count = 2;
  for (const ObjectProperty& property : properties) {
    bytes += property.name.size();
    if (bytes > kMostColumnNameBytes)
      break;
    ++count;
  }
  return count;
}

Json type_json(const ObjectColumn& column) {
  switch (column.kind) {
    case Kind::object:
      return {{"type", "SCALAR"}, {"componentType", "UINT32"}, {"required", true}};
    case Kind::number:
      return {{"type", "SCALAR"}, {"componentType", "FLOAT64"}, {"noData", kNoNumber}};
    case Kind::boolean:
      return {{"type", "SCALAR"}, {"componentType", "UINT8"}, {"noData", kNoBoolean}};
    case Kind::text:
      break;
  }
  return {{"type", "STRING"}, {"noData", ""}};
}

[[noreturn]] void refuse_table(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::corrupt, name + ": " + what);
}

void check_texts(std::span<const std::byte> table, const ObjectColumn& column, std::uint64_t rows,
                 const std::string& name) {
  std::uint32_t before = 0;
  for (std::uint64_t i = 0; i <= rows; ++i) {
    const auto start = load_little<std::uint32_t>(table.data() + column.starts + 4 * i);
    const bool is_sound = start >= before && (i > 0 || start == 0) &&
                          (i < rows ? start <= column.value_bytes : start == column.value_bytes);
    if (!is_sound)
      refuse_table(name, fmt::format("the texts of \"{}\" do not follow each other", column.id));
    before = start;
  }
}

}  // namespace

std::size_t text_columns(std::span<const ObjectProperty> properties, std::size_t count) {
  std::size_t texts = 0;
  for (std::size_t c = 0; c < count; ++c)
    texts += kind_of(properties, c) == Kind::text ? 1 : 0;
  return texts;
}

ObjectColumns::ObjectColumns(const ObjectTableShape& shape) : rows(shape.rows) {
  const std::vector<ObjectProperty>& properties = shape.properties;
  assert(shape.columns <= properties.size() + 2 &&
         shape.text_bytes.size() == text_columns(properties, shape.columns));
  std::vector<std::string> names{"object", "name"};
  for (const ObjectProperty& property : properties)
    names.push_back(property.name);
  const std::vector<std::string> ids = metadata_ids(names);
  std::size_t text = 0;
  for (std::size_t c = 0; c < shape.columns; ++c) {
    ObjectColumn column{ids[c], names[c], kind_of(properties, c)};
    column.values = bytes;
    column.value_bytes =
        column.kind == Kind::text ? shape.text_bytes[text++] : rows * bytes_of(column.kind);
    bytes = aligned8(bytes + column.value_bytes);
    if (column.kind == Kind::text) {
      column.starts = bytes;
      column.start_bytes = (rows + 1) * sizeof(std::uint32_t);
      bytes = aligned8(bytes + column.start_bytes);
    }
    columns.push_back(std::move(column));
  }
}

std::vector<std::uint32_t> objects_of(const TileMesh& mesh, const AttributeLayout& layout) {
  const PlacedValue place = placed_object(layout).value();
  std::vector<std::uint32_t> objects;
  for (const VertexArray* vertices : {&mesh.vertices, &mesh.copies.vertices}) {
    for (std::size_t v = 0; v < vertices->size(); ++v) {
      const auto object = static_cast<std::uint32_t>(place.in(vertices->attributes_of(v).data()));
      if (objects.empty() || objects.back() != object)
        objects.push_back(object);
    }
  }
  std::ranges::sort(objects);
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  return objects;
}

CellsOf cell_reader(const ObjectTable& table) {
  return [&table, cells = std::vector<std::byte>()](std::uint32_t object) mutable {
    cells.clear();
    append_cells(table.properties(), table.row(object), cells);
    return std::span<const std::byte>(cells);
  };
}

TileTableMaker::TileTableMaker(std::span<const ObjectProperty> properties)
    : columns_(named_columns(properties)) {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    columns_[c].kind = kind_of(properties, c);
    if (columns_[c].kind == Kind::text)
      columns_[c].starts.resize(sizeof(std::uint32_t));
  }
}

std::uint64_t TileTableMaker::bytes() const {
  std::uint64_t bytes = 0;
  for (const Column& column : columns_)
    bytes += aligned8(column.values.size()) + aligned8(column.starts.size());
  return bytes;
}

void TileTableMaker::add(std::uint32_t object, std::span<const std::byte> cells) {
  objects_.push_back(object);
  append(object, columns_[0].values);
  for (Column& column : std::span(columns_).subspan(1)) {
    const bool is_text = column.kind == Kind::text;
    const std::size_t head = is_text ? 1 : 0;
    const std::size_t size =
        is_text ? std::to_integer<std::size_t>(cells[0]) : bytes_of(column.kind);
    append(cells.subspan(head, size), column.values);
    if (is_text)
      append(static_cast<std::uint32_t>(column.values.size()), column.starts);
    cells = cells.subspan(head + size);
  }
  while (columns_.size() > 1 && bytes() > kMostTileTableBytes)
    columns_.pop_back();
}

TileObjects TileTableMaker::take() {
  TileObjects made;
  made.columns = static_cast<std::uint32_t>(columns_.size());
  for (const Column& column : columns_) {
    if (column.kind == Kind::text)
      made.text_bytes.push_back(column.values.size());
    append_aligned(column.values, made.table);
    append_aligned(column.starts, made.table);
  }
  made.objects = std::move(objects_);
  return made;
}

TileObjects make_tile_objects(std::span<const std::uint32_t> objects,
                              std::span<const ObjectProperty> properties,
                              const std::function<ObjectRow(std::uint32_t object)>& row) {
  TileTableMaker maker(properties);
  std::vector<std::byte> cells;
  for (const std::uint32_t object : objects) {
    cells.clear();
    append_cells(properties, row(object), cells);
    maker.add(object, cells);
  }
  return maker.take();
}

std::vector<std::uint32_t> read_objects(std::span<const std::byte> table,
                                        const ObjectColumns& columns, const std::string& name) {
  assert(table.size() == columns.bytes);
  std::vector<std::uint32_t> objects(columns.rows);
  for (std::uint64_t i = 0; i < columns.rows; ++i) {
    objects[i] = load_little<std::uint32_t>(table.data() + columns.columns[0].values + 4 * i);
    if (i > 0 && objects[i] <= objects[i - 1])
      refuse_table(name, "the objects of the table do not ascend");
  }
  for (const ObjectColumn& column : columns.columns) {
    if (column.kind == Kind::text)
      check_texts(table, column, columns.rows, name);
  }
  return objects;
}

Json object_class(const ObjectColumns& columns) {
  Json properties = Json::object();
  for (const ObjectColumn& column : columns.columns) {
    Json property = {{"name", column.name}};
    property.update(type_json(column));
    properties[column.id] = std::move(property);
  }
  return {{"properties", std::move(properties)}};
}

Json object_table_json(const ObjectColumns& columns, std::size_t first_view) {
  Json properties = Json::object();
  std::size_t view = first_view;
  for (const ObjectColumn& column : columns.columns) {
    Json property = {{"values", view++}};
    if (column.kind == Kind::text)
      property["stringOffsets"] = view++;
    properties[column.id] = std::move(property);
  }
  return {{"class", "object"}, {"count", columns.rows}, {"properties", std::move(properties)}};
}

}  // namespace meshhier::storage
