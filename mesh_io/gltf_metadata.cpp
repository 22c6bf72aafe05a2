#include "mesh_io/gltf_metadata.h"

#include "base/named_value.h"
#include "base/utf8.h"
#include "mesh_io/gltf_json.h"
#include "mesh_io/json_value.h"
#include "mesh_io/metadata_numbers.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kMostFeatures = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kMostTableColumns = 4096;
/// Longer lists end with "...": nobody reads more, and a row has room for little more.
constexpr std::uint64_t kMostListed = 256;
constexpr std::size_t kMostStringBytes = std::size_t{1} << 18;

enum class ColumnKind : std::uint8_t { number, boolean, text, choice };
struct TypeRow {
  std::string_view name;
  ColumnKind value;
  std::uint32_t components;
};
constexpr std::array kColumnTypes{
    TypeRow{"SCALAR", ColumnKind::number, 1}, TypeRow{"VEC2", ColumnKind::number, 2},
    TypeRow{"VEC3", ColumnKind::number, 3},   TypeRow{"VEC4", ColumnKind::number, 4},
    TypeRow{"MAT2", ColumnKind::number, 4},   TypeRow{"MAT3", ColumnKind::number, 9},
    TypeRow{"MAT4", ColumnKind::number, 16},  TypeRow{"BOOLEAN", ColumnKind::boolean, 1},
    TypeRow{"STRING", ColumnKind::text, 1},   TypeRow{"ENUM", ColumnKind::choice, 1}};

/// A column of a property table.
struct Column {
  ColumnKind kind = ColumnKind::number;
  NumberType type = NumberType::u8;
  std::uint32_t components = 1;
  bool is_array = false;
  std::uint64_t count = 1;  ///< elements of each array; 0: as its offsets say
  bool is_normalized = false;
  double offset = 0, scale = 1;  ///< of single numbers
  ObjectValue no_data{}, otherwise{};
  std::map<std::string, std::string> choices{};  ///< names by numbers
  ByteParts values;
  std::optional<ByteParts> array_offsets{}, string_offsets{};
  NumberType array_offset_type = NumberType::u32, string_offset_type = NumberType::u32;
  std::string place{};  ///< for messages
};

std::string text_of_number(const ObjectValue& value) {
  if (const auto* number = std::get_if<double>(&value))
    return fmt::format("{}", *number);
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : "null";
}

/// Reads the columns of a table.
class ColumnReader {
 public:
  ColumnReader(GltfFile& file, const GltfObject& schema, std::uint64_t rows)
      : file_(file), schema_(schema), rows_(rows) {}

  /// `property`: of the class; `place`: of the table.
  Column read(const GltfObject& property, const GltfObject& place) {
    Column column{.values = parts(place, "values")};
    column.place = place.place();
    const std::string type = property.text("type").value_or("");
    const auto row = std::ranges::find(kColumnTypes, type, &TypeRow::name);
    if (row == kColumnTypes.end())
      property.fail("has an unknown type");
    column.kind = row->value;
    column.components = row->components;
    column.is_array = property.flag("array");
    if (column.is_array)
      column.count = property.count("count", kMostFeatures).value_or(0);
    if (column.kind == ColumnKind::number)
      read_number(property, column);
    if (column.kind == ColumnKind::choice)
      read_choices(property, column);
    column.no_data = property.value("noData");
    column.otherwise = property.value("default");
    read_offsets(place, column);
    require_room(column);
    return column;
  }

 private:
  ByteParts parts(const GltfObject& place, const char* key) {
    return ByteParts(file_.view(place.require_index(key, file_.document().views.size())));
  }

  static NumberType component_type(const GltfObject& o, const char* key,
                                   std::string_view otherwise) {
    const auto type = number_type_of(o.text(key).value_or(std::string(otherwise)));
    if (!type)
      o.fail(fmt::format("has an unknown {}", key));
    return *type;
  }

  static void read_number(const GltfObject& property, Column& column) {
    column.type = component_type(property, "componentType", "");
    column.is_normalized = property.flag("normalized") && is_whole(column.type);
    if (column.components > 1 || column.is_array)
      return;
    column.offset = property.number("offset", 0);
    column.scale = property.number("scale", 1);
  }

  void read_choices(const GltfObject& property, Column& column) const {
    const auto choices = schema_.require_object("enums").require_object(
        property.text("enumType").value_or("").c_str());
    column.type = component_type(choices, "valueType", "UINT16");
    choices.for_each("values", [&](const GltfObject& one) {
      column.choices.emplace(text_of_number(one.value("value")), one.text("name").value_or(""));
    });
  }

  void read_offsets(const GltfObject& place, Column& column) {
    if (column.is_array && column.count == 0) {
      column.array_offsets = parts(place, "arrayOffsets");
      column.array_offset_type = component_type(place, "arrayOffsetType", "UINT32");
    }
    if (column.kind == ColumnKind::text) {
      column.string_offsets = parts(place, "stringOffsets");
      column.string_offset_type = component_type(place, "stringOffsetType", "UINT32");
    }
    if (!is_whole(column.array_offset_type) || !is_whole(column.string_offset_type))
      place.fail("has offsets that are no integers");
  }

  /// Fixed parts are checked once, the others row by row.
  void require_room(const Column& column) const {
    constexpr std::uint64_t kBits = 8;
    const auto require = [&](std::uint64_t size, std::uint64_t elements, std::uint64_t bytes) {
      if (elements > size / bytes)
        file_.fail(fmt::format("{} has {} bytes, too few for {} rows", column.place, size, rows_));
    };
    if (column.array_offsets)
      return require(column.array_offsets->size(), rows_ + 1, bytes_of(column.array_offset_type));
    if (column.count > 0 && rows_ > std::numeric_limits<std::uint64_t>::max() / 16 / column.count)
      file_.fail(column.place + " has lists that are too long");
    const std::uint64_t elements = rows_ * column.count * column.components;
    if (column.kind == ColumnKind::text)
      require(column.string_offsets->size(), elements + 1, bytes_of(column.string_offset_type));
    else if (column.kind == ColumnKind::boolean)
      require(column.values.size(), elements / kBits + (elements % kBits > 0 ? 1 : 0), 1);
    else
      require(column.values.size(), elements, bytes_of(column.type));
  }

  GltfFile& file_;
  const GltfObject& schema_;
  std::uint64_t rows_;
};

class GltfPropertyTable final : public FeatureTable {
 public:
  GltfPropertyTable(GltfFile& file, std::uint64_t rows) : file_(file), rows_(rows) {}

  /// `meaning`: the semantic of its class's property, as "ID".
  void add(std::string name, std::string meaning, Column column) {
    names_.push_back(std::move(name));
    meanings_.push_back(std::move(meaning));
    columns_.push_back(std::move(column));
  }

  std::uint64_t rows() const override { return rows_; }
  const std::vector<std::string>& columns() const override { return names_; }
  std::string_view meaning(std::size_t column) const override { return meanings_[column]; }
  ObjectValue value(std::size_t number, std::uint64_t row) override {
    Column& column = columns_[number];
    ObjectValue value = stored(column, row);
    const bool is_none =
        !std::holds_alternative<std::monostate>(column.no_data) && value == column.no_data;
    if (is_none)
      return column.otherwise;
    if (auto* number_here = std::get_if<double>(&value)) {
      if (column.is_normalized)
        *number_here = fraction_of(column.type, *number_here);
      *number_here = *number_here * column.scale + column.offset;
      if (!std::isfinite(*number_here))
        return {};
    }
    return value;
  }

 private:
  ObjectValue stored(Column& column, std::uint64_t row) {
    if (!column.is_array && column.components == 1)
      return element(column, row);
    std::uint64_t begin = row * column.count, end = begin + column.count;
    if (column.array_offsets) {
      begin = offset(column, *column.array_offsets, column.array_offset_type, row);
      end = offset(column, *column.array_offsets, column.array_offset_type, row + 1);
      require_order(column, begin, end);
    }
    return list(column, begin * column.components, end * column.components);
  }

  std::uint64_t offset(const Column& column, ByteParts& offsets, NumberType type,
                       std::uint64_t index) const {
    const std::size_t bytes = bytes_of(type);
    if (index >= offsets.size() / bytes)
      file_.fail(column.place + " has offsets that lead beyond its values");
    const ObjectValue value = number_in(type, offsets.at(index * bytes, bytes));
    const auto* number = std::get_if<double>(&value);
    if (number == nullptr || *number < 0)
      file_.fail(column.place + " has an offset that is none");
    return static_cast<std::uint64_t>(*number);
  }

  void require_order(const Column& column, std::uint64_t begin, std::uint64_t end) const {
    constexpr std::uint64_t kMostOffset = std::uint64_t{1} << 40;
    if (begin > end || end > kMostOffset)
      file_.fail(column.place + " has offsets that do not ascend");
  }

  ObjectValue list(Column& column, std::uint64_t begin, std::uint64_t end) {
    std::string text = "[";
    for (std::uint64_t i = begin; i < end && i - begin < kMostListed; ++i) {
      const ObjectValue value = element(column, i);
      text += i == begin ? "" : ", ";
      if (const auto* flag = std::get_if<bool>(&value))
        text += *flag ? "true" : "false";
      else if (column.kind == ColumnKind::number)
        text += text_of_component(column, value);
      else
        text += storage::json_text(Json(text_of_number(value)));
    }
    return text + (end - begin > kMostListed ? ", ...]" : "]");
  }

  static std::string text_of_component(const Column& column, const ObjectValue& value) {
    const auto* number = std::get_if<double>(&value);
    if (number == nullptr)
      return text_of_number(value);
    if (column.type == NumberType::f32)
      return fmt::format("{}", static_cast<float>(*number));
    return fmt::format("{}", column.is_normalized ? fraction_of(column.type, *number) : *number);
  }

  /// Returns an element by its number among those of all rows.
  ObjectValue element(Column& column, std::uint64_t i) {
    if (column.kind == ColumnKind::text)
      return string(column, i);
    constexpr std::uint64_t kBits = 8;
    if (column.kind == ColumnKind::boolean) {
      const auto byte = std::to_integer<unsigned>(part(column, i / kBits, 1)[0]);
      return (byte >> (i % kBits) & 1) != 0;
    }
    const std::size_t bytes = bytes_of(column.type);
    ObjectValue number = number_in(column.type, part(column, i * bytes, bytes));
    if (column.kind == ColumnKind::number)
      return number;
    const auto choice = column.choices.find(text_of_number(number));
    return choice == column.choices.end() ? text_of_number(number) : choice->second;
  }

  ObjectValue string(Column& column, std::uint64_t i) {
    const std::uint64_t begin =
        offset(column, *column.string_offsets, column.string_offset_type, i);
    const std::uint64_t end =
        offset(column, *column.string_offsets, column.string_offset_type, i + 1);
    require_order(column, begin, end);
    if (end - begin > kMostStringBytes)
      file_.fail(fmt::format("{} has a text of {} bytes; up to {} are read", column.place,
                             end - begin, kMostStringBytes));
    const auto bytes = part(column, begin, static_cast<std::size_t>(end - begin));
    return sound_utf8({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }

  std::span<const std::byte> part(Column& column, std::uint64_t at, std::size_t bytes) const {
    if (at > column.values.size() || bytes > column.values.size() - at)
      file_.fail(column.place + " leads beyond its values");
    return column.values.at(at, bytes);
  }

  GltfFile& file_;
  std::uint64_t rows_;
  std::vector<std::string> names_, meanings_;
  std::vector<Column> columns_;
};

constexpr const char* kMetadataPlace = "extensions.EXT_structural_metadata";

/// Returns the schema, which may be in a file of its own, as JSON that stays.
std::shared_ptr<const Json> schema_of(const GltfFile& file, const GltfObject& metadata) {
  const auto uri = metadata.text("schemaUri");
  if (uri && !metadata.has("schema"))
    return std::make_shared<const Json>(
        parse_gltf_json(file.text_of(*uri, "its schema"), file.path(), file.room().memory_bytes));
  return metadata.require_object("schema").copy();
}

}  // namespace

std::vector<GltfFeatureIds> feature_ids_of(const GltfFile& file,
                                           const std::shared_ptr<const Json>& extension) {
  std::vector<GltfFeatureIds> all;
  if (!extension)
    return all;
  const GltfObject features(*extension, file.path(), "features");
  features.for_each("featureIds", [&](const GltfObject& one) {
    GltfFeatureIds ids{.count = one.require_count("featureCount", kMostFeatures),
                       .null_id = one.count("nullFeatureId", kMostFeatures),
                       .is_in_texture = one.has("texture"),
                       .table = one.index("propertyTable", property_table_count(file))};
    if (const auto attribute = one.count("attribute", kMostFeatures))
      ids.attribute = fmt::format("_FEATURE_ID_{}", *attribute);
    all.push_back(std::move(ids));
  });
  return all;
}

std::size_t property_table_count(const GltfFile& file) {
  const auto& metadata = file.document().metadata;
  return metadata ? GltfObject(*metadata, file.path(), kMetadataPlace).item_count("propertyTables")
                  : 0;
}

GltfOtherProperties other_properties_of(const GltfFile& file) {
  if (!file.document().metadata)
    return {};
  const GltfObject metadata(*file.document().metadata, file.path(), kMetadataPlace);
  return {metadata.item_count("propertyTextures"), metadata.item_count("propertyAttributes")};
}

std::unique_ptr<FeatureTable> open_property_table(GltfFile& file, std::uint32_t number) {
  const GltfObject metadata(*file.document().metadata, file.path(), kMetadataPlace);
  const auto json = schema_of(file, metadata);
  const GltfObject schema(*json, file.path(), "schema");
  const GltfObject place = *metadata.item("propertyTables", number);
  const std::uint64_t rows = place.require_count("count", kMostFeatures);
  const GltfObject type =
      schema.require_object("classes").require_object(place.text("class").value_or("").c_str());
  auto table = std::make_unique<GltfPropertyTable>(file, rows);
  ColumnReader reader(file, schema, rows);
  const auto columns = place.object("properties");
  const auto properties = type.object("properties");
  if (!columns || !properties)
    return table;
  for (const std::string& name : columns->keys(kMostTableColumns)) {
    const GltfObject property = properties->require_object(name.c_str());
    table->add(name, property.text("semantic").value_or(""),
               reader.read(property, columns->require_object(name.c_str())));
  }
  return table;
}

}  // namespace meshhier::mesh_io
