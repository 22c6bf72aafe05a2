#include "storage/format/tile_object_table.h"

#include "base/error.h"
#include "hierarchy/value_channels.h"
#include "storage/format/glb.h"
#include "storage/format/metadata_ids.h"

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

std::string_view text_of(const ObjectValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text == nullptr ? std::string_view() : cut(*text);
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

/// Collects rows, column by column, and lets the last columns go when they become too many bytes.
class TableMaker {
 public:
  explicit TableMaker(std::span<const ObjectProperty> properties)
      : columns_(named_columns(properties)) {
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      columns_[c].kind = kind_of(properties, c);
      if (columns_[c].kind == Kind::text)
        columns_[c].starts.resize(sizeof(std::uint32_t));
    }
  }

  void add(std::uint32_t object, const ObjectRow& row) {
    append(object, columns_[0].values);
    for (std::size_t c = 1; c < columns_.size(); ++c)
      c == 1 ? put_text(columns_[c], cut(row.name)) : put(columns_[c], row.values[c - 2]);
    while (columns_.size() > 1 && bytes() > kMostTileTableBytes)
      columns_.pop_back();
  }

  TileObjects take(std::vector<std::uint32_t> objects) {
    TileObjects made;
    made.columns = static_cast<std::uint32_t>(columns_.size());
    for (const Column& column : columns_) {
      if (column.kind == Kind::text)
        made.text_bytes.push_back(column.values.size());
      append(column.values, made.table);
      append(column.starts, made.table);
    }
    made.objects = std::move(objects);
    return made;
  }

 private:
  using Bytes = std::vector<std::byte>;
  struct Column {
    Kind kind{};
    Bytes values, starts;
  };

  template <Scalar T>
  static void append(T number, Bytes& to) {
    to.resize(to.size() + sizeof number);
    store_little(number, to.data() + to.size() - sizeof number);
  }
  static void append(const Bytes& bytes, Bytes& to) {
    to.insert(to.end(), bytes.begin(), bytes.end());
    to.resize(aligned8(to.size()));
  }

  static void put_text(Column& column, std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    column.values.insert(column.values.end(), bytes.begin(), bytes.end());
    append(static_cast<std::uint32_t>(column.values.size()), column.starts);
  }

  static void put(Column& column, const ObjectValue& value) {
    if (column.kind == Kind::text)
      return put_text(column, text_of(value));
    if (column.kind == Kind::number) {
      const auto* number = std::get_if<double>(&value);
      return append(number == nullptr ? kNoNumber : *number, column.values);
    }
    const auto* known = std::get_if<bool>(&value);
    append(known == nullptr ? kNoBoolean : static_cast<std::uint8_t>(*known ? 1 : 0),
           column.values);
  }

  std::uint64_t bytes() const {
    std::uint64_t bytes = 0;
    for (const Column& column : columns_)
      bytes += aligned8(column.values.size()) + aligned8(column.starts.size());
    return bytes;
  }

  std::vector<Column> columns_;
};

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

ObjectColumns::ObjectColumns(std::span<const ObjectProperty> properties, std::size_t count,
                             std::uint64_t rows, std::span<const std::uint64_t> text_bytes) {
  assert(count <= properties.size() + 2 && text_bytes.size() == text_columns(properties, count));
  std::vector<std::string> names{"object", "name"};
  for (const ObjectProperty& property : properties)
    names.push_back(property.name);
  const std::vector<std::string> ids = metadata_ids(names);
  std::size_t text = 0;
  for (std::size_t c = 0; c < count; ++c) {
    ObjectColumn column{ids[c], names[c], kind_of(properties, c)};
    column.values = bytes;
    column.value_bytes =
        column.kind == Kind::text ? text_bytes[text++] : rows * bytes_of(column.kind);
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
      const auto object = static_cast<std::uint32_t>(
          value_in(place.type, vertices->attributes_of(v).data() + place.channel));
      if (objects.empty() || objects.back() != object)
        objects.push_back(object);
    }
  }
  std::ranges::sort(objects);
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  return objects;
}

TileObjects make_tile_objects(std::vector<std::uint32_t> objects,
                              std::span<const ObjectProperty> properties,
                              const std::function<ObjectRow(std::uint32_t object)>& row) {
  TableMaker maker(properties);
  for (const std::uint32_t object : objects)
    maker.add(object, row(object));
  return maker.take(std::move(objects));
}

std::vector<std::uint32_t> read_objects(std::span<const std::byte> table,
                                        const ObjectColumns& columns, std::uint64_t rows,
                                        const std::string& name) {
  assert(table.size() == columns.bytes);
  std::vector<std::uint32_t> objects(rows);
  for (std::uint64_t i = 0; i < rows; ++i) {
    objects[i] = load_little<std::uint32_t>(table.data() + columns.columns[0].values + 4 * i);
    if (i > 0 && objects[i] <= objects[i - 1])
      refuse_table(name, "the objects of the table do not ascend");
  }
  for (const ObjectColumn& column : columns.columns) {
    if (column.kind == Kind::text)
      check_texts(table, column, rows, name);
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

Json object_table_json(const ObjectColumns& columns, std::uint64_t rows, std::size_t first_view) {
  Json properties = Json::object();
  std::size_t view = first_view;
  for (const ObjectColumn& column : columns.columns) {
    Json property = {{"values", view++}};
    if (column.kind == Kind::text)
      property["stringOffsets"] = view++;
    properties[column.id] = std::move(property);
  }
  return {{"class", "object"}, {"count", rows}, {"properties", std::move(properties)}};
}

}  // namespace meshhier::storage
