// The table beside a mesh: a row of properties for each object, which it knows by id or by name.
#pragma once

#include "import/object_names.h"
#include "import/property_types.h"
#include "import/row_sort.h"
#include "mesh_io/record_table.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::importing {

struct PropertyTableCounts {
  mesh_io::RecordCounts read;
  std::uint64_t keyless = 0;    ///< rows whose id or name is empty
  std::uint64_t duplicate = 0;  ///< rows whose key a row before has: that one counts
  std::uint64_t unmatched = 0;  ///< rows that are no object's
};

/// Reads the table, then hands out rows by ascending keys. For one thread.
class PropertyTable {
 public:
  /// A row that was found.
  struct Found {
    std::uint64_t row = 0;
    std::string name{};  ///< that the table gives the object; may be empty
    ObjectValues values{};
  };

  /// Ids of objects: there are none, so that names are; texts; or numbers, of which "007" and "7.0"
  /// are one.
  enum class Ids : std::uint8_t { none, texts, numbers };

  /// `ids`: those of objects; if there are any, a column "name" names them.
  PropertyTable(Ids ids, PropertyNames& names, PropertyTypes& types, const ImportRoom& room,
                std::uint64_t memory_bytes);

  /// Throws as mesh_io::read_records(), and Error(input) if there is neither a column "id" nor one
  /// "name", in any letters. Without "id" a column of the first row that has one of
  /// kIdColumns is it.
  void read(mesh_io::InputStream& stream, const std::filesystem::path& path);
  /// Returns whether objects that have ids are known by these.
  bool knows_ids() const { return has_id_column_; }

  /// Returns the first row of that id, or else, unless it `is_id`, of that name. Keys ascend from
  /// call to call.
  const Found* find(std::string_view key, bool is_id);
  /// Returns the counts. Called when all objects have asked.
  PropertyTableCounts counts();

 private:
  enum class Key : std::uint8_t { id, name };
  /// A column of the table: its property, or that it is a key.
  struct Column {
    std::string name;
    std::optional<Key> key{};
    std::optional<std::uint8_t> property{};
    bool is_dropped = false;
  };

  void take(std::span<const mesh_io::RecordField> fields, mesh_io::RecordTexts texts);
  void choose_key_columns(std::span<const mesh_io::RecordField> fields);
  Column& column_of(const std::string& name, std::size_t likely);
  bool is_property(Key key) const;
  void add(Key kind, const std::string& key, const std::string& bytes);
  void load(std::string_view key);

  bool has_ids_, are_numbers_;
  std::string id_name_{}, name_name_{};  ///< of the first row's columns
  PropertyNames& names_;
  PropertyTypes& types_;
  std::vector<Column> columns_;
  bool has_id_column_ = false, has_name_column_ = false;
  RowSort rows_;
  bool is_sorted_ = false, is_row_ = false;
  std::string key_;  ///< of the rows that are loaded
  std::optional<Found> by_id_, by_name_;
  std::vector<bool> matched_;
  PropertyTableCounts counts_;
};

}  // namespace meshhier::importing
