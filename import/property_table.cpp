#include "import/property_table.h"

#include "base/error.h"
#include "base/small_letters.h"
#include "import/id_columns.h"
#include "import/row_bytes.h"
#include "mesh_io/input_error.h"
#include "mesh_io/number_text.h"

#include <algorithm>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

/// A bit is kept for each.
constexpr std::uint64_t kMostRows = std::uint64_t{1} << 27;

/// Returns a key as objects have it: a number of JSON is its text.
/// `is_number`: texts are numbers where they can be.
std::string key_text(const ObjectValue& value, bool is_number) {
  const auto* text = std::get_if<std::string>(&value);
  const auto* number = std::get_if<double>(&value);
  if (text == nullptr)
    return number != nullptr ? fmt::format("{}", *number) : std::string();
  const auto parsed = is_number ? mesh_io::parse_decimal(*text) : std::nullopt;
  return parsed ? fmt::format("{}", parsed->value + 0.0) : sound_name(*text);
}

}  // namespace

PropertyTable::PropertyTable(Ids ids, PropertyNames& names, PropertyTypes& types,
                             const ImportRoom& room, std::uint64_t memory_bytes)
    : has_ids_(ids != Ids::none),
      are_numbers_(ids == Ids::numbers),
      names_(names),
      types_(types),
      rows_(room, memory_bytes) {}

void PropertyTable::read(mesh_io::InputStream& stream, const std::filesystem::path& path) {
  counts_.read = mesh_io::read_records(
      stream, path, [&](std::span<const mesh_io::RecordField> fields, mesh_io::RecordTexts texts) {
        take(fields, texts);
      });
  if (!has_id_column_ && !has_name_column_ && counts_.read.records > 0) {
    mesh_io::fail_file(path,
                       "has no column \"id\" or \"name\", by which its rows belong to objects");
  }
  if (counts_.read.records > kMostRows)
    mesh_io::fail_file(path, fmt::format("has more than {} rows", kMostRows));
  matched_.resize(counts_.read.records);
  rows_.sort();
  is_row_ = rows_.next();
}

/// The first row decides: exactly this name comes before others in other letters. Other names of
/// ids than "id" count there, too.
void PropertyTable::choose_key_columns(std::span<const mesh_io::RecordField> fields) {
  const auto choose = [&](std::string_view name, std::string& chosen) {
    for (const mesh_io::RecordField& field : fields) {
      if (field.column == name || (chosen.empty() && small_letters(field.column) == name))
        chosen = field.column;
    }
  };
  choose("id", id_name_);
  choose("name", name_name_);
  for (const std::string_view name : kIdColumns) {
    if (id_name_.empty())
      choose(name, id_name_);
  }
}

/// A key is a property as well where it says more than the object's name does.
bool PropertyTable::is_property(Key key) const {
  return has_ids_ ? key == Key::id && has_name_column_ : key == Key::name && has_id_column_;
}

/// `likely`: where it is if columns come in the same order as before.
PropertyTable::Column& PropertyTable::column_of(const std::string& name, std::size_t likely) {
  if (likely < columns_.size() && columns_[likely].name == name)
    return columns_[likely];
  const auto known = std::ranges::find(columns_, name, &Column::name);
  if (known != columns_.end())
    return *known;
  constexpr std::size_t kMostColumns = 4096;
  if (columns_.size() == kMostColumns)
    throw Error(ErrorCode::input,
                "the table of objects has more than 4096 different keys; are they values?");
  Column column{name};
  const std::string small = small_letters(name);
  if (!has_id_column_ && (id_name_.empty() ? small == "id" : name == id_name_))
    column.key = Key::id;
  else if (!has_name_column_ && (name_name_.empty() ? small == "name" : name == name_name_))
    column.key = Key::name;
  has_id_column_ = has_id_column_ || column.key == Key::id;
  has_name_column_ = has_name_column_ || column.key == Key::name;
  columns_.push_back(column);
  return columns_.back();
}

void PropertyTable::take(std::span<const mesh_io::RecordField> fields, mesh_io::RecordTexts texts) {
  std::string id, name;
  if (columns_.empty())
    choose_key_columns(fields);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto key = column_of(fields[i].column, i).key;
    if (key == Key::id)
      id = key_text(fields[i].value, are_numbers_);
    else if (key == Key::name)
      name = key_text(fields[i].value, false);
  }
  ObjectValues values;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    Column& column = column_of(fields[i].column, i);
    const bool is_none = std::holds_alternative<std::monostate>(fields[i].value);
    if (is_none || column.is_dropped || (column.key && !is_property(*column.key)))
      continue;
    if (!column.property)
      column.property = names_.number(column.name);
    column.is_dropped = !column.property;
    if (column.is_dropped)
      continue;
    types_.note(*column.property, fields[i].value, texts);
    values.emplace_back(*column.property, fields[i].value);
  }
  std::string bytes;
  put_raw(bytes, counts_.read.records++);
  put_text(bytes, name);
  bytes += encode_values(values);
  counts_.keyless += id.empty() && name.empty() ? 1 : 0;
  add(Key::id, id, bytes);
  if (!has_ids_ || !has_id_column_)
    add(Key::name, name, bytes);
}

void PropertyTable::add(Key kind, const std::string& key, const std::string& bytes) {
  if (!key.empty())
    rows_.add({key, std::string(1, static_cast<char>(kind)) + bytes});
}

/// Loads the first row of each kind that has the key.
void PropertyTable::load(std::string_view key) {
  key_ = key;
  by_id_.reset();
  by_name_.reset();
  for (; is_row_ && rows_.row().key <= key; is_row_ = rows_.next()) {
    if (rows_.row().key < key)
      continue;
    std::string_view bytes = rows_.row().bytes;
    const auto kind = take_raw<Key>(bytes);
    std::optional<Found>& found = kind == Key::id ? by_id_ : by_name_;
    Found row{take_raw<std::uint64_t>(bytes), take_text(bytes)};
    row.values = decode_values(bytes);
    counts_.duplicate += found ? 1 : 0;
    if (!found)
      found = std::move(row);
    else
      matched_[row.row] = true;  // told as a duplicate
  }
}

const PropertyTable::Found* PropertyTable::find(std::string_view key, bool is_id) {
  if (key != key_ || (!by_id_ && !by_name_))
    load(key);
  const std::optional<Found>& found = by_id_ || is_id ? by_id_ : by_name_;
  if (!found)
    return nullptr;
  matched_[found->row] = true;
  return &*found;
}

PropertyTableCounts PropertyTable::counts() {
  counts_.unmatched = static_cast<std::uint64_t>(std::ranges::count(matched_, false));
  return counts_;
}

}  // namespace meshhier::importing
