#include "mesh_io/batch_table.h"

#include "base/error.h"
#include "base/named_value.h"
#include "base/utf8.h"
#include "mesh_io/gltf_json.h"
#include "mesh_io/input_error.h"
#include "mesh_io/json_value.h"
#include "mesh_io/metadata_numbers.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostBatchColumns = 4096;
constexpr std::array kBatchTypes{NamedValue{"SCALAR", 1U}, NamedValue{"VEC2", 2U},
                                 NamedValue{"VEC3", 3U}, NamedValue{"VEC4", 4U}};

/// Numbers of the binary part.
struct BinaryColumn {
  NumberType type = NumberType::f32;
  std::size_t components = 1;
  std::uint64_t offset = 0;
  ByteParts bytes;
};

class BatchTable final : public FeatureTable {
 public:
  BatchTable(std::shared_ptr<const storage::File> file, const BatchTablePlace& place,
             const Json& json)
      : path_(file->path()),
        most_rows_(place.rows),
        binary_(std::move(file), place.json + place.json_bytes, place.binary_bytes) {
    for (const auto& [name, value] : json.items()) {
      if (columns_.size() >= kMostBatchColumns || !add(name, value))
        note_unread(name, value);
    }
    for (const Column& column : columns_)
      rows_ = std::max(rows_, rows_of(column));
  }

  std::uint64_t rows() const override { return rows_; }
  const std::vector<std::string>& columns() const override { return names_; }
  std::vector<std::string> unread() const override { return unread_; }

  ObjectValue value(std::size_t number, std::uint64_t row) override {
    Column& column = columns_[number];
    if (row >= rows_of(column))
      return {};
    return column.numbers ? numbers(*column.numbers, row)
                          : value_of_json(column.list[static_cast<std::size_t>(row)]);
  }

 private:
  struct Column {
    Json list{};
    std::optional<BinaryColumn> numbers{};
  };

  /// Notes what is there that is no column: hierarchies of classes, extensions.
  void note_unread(const std::string& name, const Json& value) {
    constexpr std::size_t kMostNoted = 64;
    if (name == "extensions" && value.is_object()) {
      for (const auto& [extension, content] : value.items())
        note_unread(extension, content);
    } else if (name != "extras" && unread_.size() < kMostNoted) {
      unread_.push_back(name);
    }
  }

  /// Returns whether it is a column: hierarchies, extensions and extras are objects without a place
  /// in the binary part.
  bool add(const std::string& name, const Json& value) {
    Column column;
    if (value.is_array())
      column.list = value;
    else if (value.is_object() && value.contains("byteOffset"))
      column.numbers = binary_column(name, value);
    else
      return false;
    names_.push_back(name);
    columns_.push_back(std::move(column));
    return true;
  }

  BinaryColumn binary_column(const std::string& name, const Json& value) const {
    const GltfObject object(value, path_, "batch table, " + in_quotes(name));
    const auto type = number_type_of(object.text("componentType").value_or(""));
    const auto components = value_named(kBatchTypes, object.text("type").value_or(""));
    if (!type || !components)
      object.fail("has an unknown componentType or type");
    return {*type, *components, object.require_count("byteOffset", binary_.size()),
            ByteParts({&binary_, 0, binary_.size()})};
  }

  std::uint64_t rows_of(const Column& column) const {
    if (!column.numbers)
      return column.list.size();
    const BinaryColumn& numbers = *column.numbers;
    return std::min(most_rows_, (numbers.bytes.size() - numbers.offset) /
                                    (bytes_of(numbers.type) * numbers.components));
  }

  static ObjectValue numbers(BinaryColumn& column, std::uint64_t row) {
    const std::size_t bytes = bytes_of(column.type);
    const auto one = [&](std::size_t i) {
      const std::uint64_t at = column.offset + (row * column.components + i) * bytes;
      return number_in(column.type, column.bytes.at(at, bytes));
    };
    if (column.components == 1)
      return one(0);
    std::string text = "[";
    for (std::size_t i = 0; i < column.components; ++i) {
      const ObjectValue value = one(i);
      const auto* number = std::get_if<double>(&value);
      text += (i > 0 ? ", " : "") + (number != nullptr ? fmt::format("{}", *number) : "null");
    }
    return text + "]";
  }

  std::filesystem::path path_;
  std::uint64_t most_rows_;  ///< of numbers: those of other columns stand behind them
  GltfFileBytes binary_;
  std::vector<std::string> names_, unread_;
  std::vector<Column> columns_;
  std::uint64_t rows_ = 0;
};

}  // namespace

std::unique_ptr<FeatureTable> open_batch_table(std::shared_ptr<const storage::File> file,
                                               const BatchTablePlace& place,
                                               std::uint64_t most_bytes) {
  if (place.json_bytes == 0)
    return nullptr;
  const std::filesystem::path path = file->path();
  if (place.json_bytes > most_bytes) {
    throw Error(ErrorCode::budget,
                fmt::format("{}: the batch table of the tile takes {} bytes, more than there are; "
                            "give a larger memory_budget",
                            path.string(), place.json_bytes));
  }
  std::string text(static_cast<std::size_t>(place.json_bytes), '\0');
  file->read_exact(place.json, std::as_writable_bytes(std::span(text)));
  text.erase(text.find_last_not_of('\0') + 1);  // some programs pad it with zeros
  const Json json = parse_gltf_json(sound_utf8(text), path, most_bytes);
  if (!json.is_object())
    fail_file(path, "the batch table of the tile is no object of JSON");
  return std::make_unique<BatchTable>(std::move(file), place, json);
}

}  // namespace meshhier::mesh_io
