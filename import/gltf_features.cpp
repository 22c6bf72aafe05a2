#include "import/gltf_features.h"

#include "base/error.h"
#include "base/small_letters.h"
#include "import/id_columns.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

constexpr std::array<std::string_view, 1> kNameColumns{"name"};
/// The attributes that say rows of a batch table; old b3dm have the second one.
constexpr std::array<const char*, 2> kBatchIds{"_BATCHID", "BATCHID"};

std::string text_of_value(const ObjectValue& value) {
  if (const auto* number = std::get_if<double>(&value))
    return fmt::format("{}", *number);
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : std::string();
}

}  // namespace

const char* batch_ids_in(const mesh_io::GltfAttributes& attributes) {
  const auto found =
      std::ranges::find_if(kBatchIds, [&](const char* name) { return attributes.contains(name); });
  return found == kBatchIds.end() ? nullptr : *found;
}

GltfFeatures::GltfFeatures(mesh_io::GltfFile& file, MeshObjects& objects,
                           mesh_io::FeatureTable* batch, std::string prefix)
    : file_(file), objects_(objects), batch_(batch), prefix_(std::move(prefix)) {}

std::optional<mesh_io::GltfFeatureIds> GltfFeatures::ids_of(
    const std::shared_ptr<const nlohmann::json>& extension,
    const mesh_io::GltfAttributes& attributes) const {
  std::vector<mesh_io::GltfFeatureIds> all = feature_ids_of(file_, extension);
  std::erase_if(all, [&](const mesh_io::GltfFeatureIds& ids) {
    return ids.is_in_texture || (ids.attribute && !attributes.contains(*ids.attribute));
  });
  if (const char* batches = batch_ids_in(attributes); all.empty() && batches != nullptr)
    return mesh_io::GltfFeatureIds{.attribute = batches};
  const auto best = std::ranges::find_if(
      all, [](const mesh_io::GltfFeatureIds& ids) { return ids.table.has_value(); });
  if (all.empty())
    return std::nullopt;
  return best != all.end() ? *best : all.front();
}

std::uint32_t GltfFeatures::object_of(const mesh_io::GltfFeatureIds& ids, double feature) {
  const bool is_none =
      !(feature >= 0) || (ids.null_id && feature == static_cast<double>(*ids.null_id));
  if (is_none)
    return objects_.names.number("");
  const double number = std::floor(feature);
  Rows rows;
  if (ids.table)
    rows = rows_of(*ids.table);
  else if (batch_ != nullptr && ids.attribute && !ids.attribute->starts_with("_FEATURE_ID"))
    rows = batch_rows();
  if (number < static_cast<double>(rows.count))
    return rows.first + static_cast<std::uint32_t>(number);
  return objects_.names.number(fmt::format("{}feature {:.0f}", prefix_, number),
                               prefix_.empty() ? fmt::format("{:.0f}", number) : std::string());
}

const GltfFeatures::Rows& GltfFeatures::rows_of(std::uint32_t table) {
  const auto known = tables_.find(table);
  if (known != tables_.end())
    return known->second;
  const std::string way = table > 0 ? fmt::format("table {}/", table) : std::string();
  const Rows rows =
      rows_if_sound([&] { return add_rows(*open_property_table(file_, table), way); });
  return tables_.emplace(table, rows).first->second;
}

/// Metadata that nobody asked for stops no mesh.
template <class Read>
GltfFeatures::Rows GltfFeatures::rows_if_sound(const Read& read) {
  try {
    return read();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input || !objects_.choice.is_evident())
      throw;
    ++unread_tables_;
    return {};
  }
}

const GltfFeatures::Rows& GltfFeatures::batch_rows() {
  if (!batched_)
    batched_ = rows_if_sound([&] { return add_rows(*batch_, ""); });
  return *batched_;
}

GltfFeatures::Rows GltfFeatures::add_rows(mesh_io::FeatureTable& table, const std::string& way) {
  Rows rows{objects_.names.count(), table.columns().empty() ? 0 : table.rows()};
  if (rows.count > kMostObjects)
    file_.fail(fmt::format("a table of {} features, more than {}", rows.count, kMostObjects));
  for (const std::string& name : table.unread())
    objects_.properties.drop(name);
  const NamingColumns columns{column_that(table, "ID", kIdColumns),
                              column_that(table, "NAME", kNameColumns)};
  const std::optional<std::size_t> names = columns.name ? columns.name : columns.id;
  std::vector<std::optional<std::uint8_t>> properties;
  for (std::size_t i = 0; i < table.columns().size() && rows.count > 0; ++i)
    properties.push_back(i == names ? std::nullopt
                                    : objects_.properties.number(table.columns()[i]));
  for (std::uint64_t row = 0; row < rows.count; ++row) {
    file_.room().check();
    FoundObject object = named_row(table, columns, row, way);
    for (std::size_t i = 0; i < properties.size(); ++i) {
      if (!properties[i])
        continue;
      ObjectValue value = table.value(i, row);
      if (!std::holds_alternative<std::monostate>(value))
        object.values.emplace_back(*properties[i], std::move(value));
    }
    objects_.names.add(object);
  }
  return rows;
}

/// `way`: tells the table from others of the file. Numbers of rows are ids where there are no
/// others, and no other file.
FoundObject GltfFeatures::named_row(mesh_io::FeatureTable& table, const NamingColumns& columns,
                                    std::uint64_t row, const std::string& way) const {
  const auto text = [&](const std::optional<std::size_t>& column) {
    return column ? text_of_value(table.value(*column, row)) : std::string();
  };
  FoundObject object{text(columns.name), text(columns.id)};
  if (object.name.empty())
    object.name = object.id;
  if (object.name.empty())
    object.name = fmt::format("{}{}feature {}", prefix_, way, row);
  if (!columns.id && prefix_.empty())
    object.id = fmt::format("{}{}", way, row);
  return object;
}

/// Returns the column of that meaning, or else of the first of these names, whose values tell the
/// rows apart.
std::optional<std::size_t> GltfFeatures::column_that(
    mesh_io::FeatureTable& table, std::string_view meaning,
    std::span<const std::string_view> names) const {
  const std::size_t count = table.columns().size();
  for (std::size_t i = 0; i < count; ++i) {
    if (table.meaning(i) == meaning && tells_apart(table, i))
      return i;
  }
  for (const std::string_view name : names) {
    for (std::size_t i = 0; i < count; ++i) {
      if (small_letters(table.columns()[i]) == name && tells_apart(table, i))
        return i;
    }
  }
  return std::nullopt;
}

/// Returns whether all values that are there differ, and are more than the numbers of their rows,
/// from 0 or in several files from 1 on, which those of other files have as well. Compares hashes:
/// two values of one hash only take the column its role.
bool GltfFeatures::tells_apart(mesh_io::FeatureTable& table, std::size_t column) const {
  file_.require_memory(sizeof(std::uint64_t) * table.rows(), "a table of features");
  std::vector<std::uint64_t> hashes;
  bool are_rows = true, are_next = !prefix_.empty();
  hashes.reserve(static_cast<std::size_t>(table.rows()));
  for (std::uint64_t row = 0; row < table.rows(); ++row) {
    const std::string text = text_of_value(table.value(column, row));
    are_rows = are_rows && text == fmt::format("{}", row);
    are_next = are_next && text == fmt::format("{}", row + 1);
    if (!text.empty())
      hashes.push_back(storage::checksum(std::as_bytes(std::span(text))));
  }
  std::ranges::sort(hashes);
  return !hashes.empty() && !are_rows && !are_next &&
         std::ranges::adjacent_find(hashes) == hashes.end();
}

}  // namespace meshhier::importing
