#include "import/gltf_features.h"

#include "base/error.h"
#include "base/small_letters.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

/// Columns that name features, in small letters; the first one whose values all differ does.
constexpr std::array<std::string_view, 8> kNamingColumns{"name",  "id",   "gml_id",   "gml:id",
                                                         "gmlid", "guid", "globalid", "batchid"};
constexpr const char* kBatchIds = "_BATCHID";

std::string text_of_value(const ObjectValue& value) {
  if (const auto* number = std::get_if<double>(&value))
    return fmt::format("{}", *number);
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : std::string();
}

}  // namespace

GltfFeatures::GltfFeatures(mesh_io::GltfFile& file, MeshObjects& objects,
                           mesh_io::FeatureTable* batch, std::string prefix)
    : file_(file), objects_(objects), batch_(batch), prefix_(std::move(prefix)) {}

std::optional<mesh_io::GltfFeatureIds> GltfFeatures::ids_of(
    const mesh_io::GltfPrimitive& primitive) {
  std::vector<mesh_io::GltfFeatureIds> all = feature_ids_of(file_, primitive);
  std::erase_if(all, [&](const mesh_io::GltfFeatureIds& ids) {
    const bool is_there = ids.attribute && primitive.attribute(*ids.attribute);
    in_textures_ += is_there ? 0 : 1;
    return !is_there;
  });
  if (all.empty() && primitive.attribute(kBatchIds))
    return mesh_io::GltfFeatureIds{.attribute = kBatchIds};
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
  else if (batch_ != nullptr && ids.attribute == kBatchIds)
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
  const Rows rows = rows_if_sound([&] {
    const auto opened = open_property_table(file_, table);
    unread_tables_ += opened ? 0 : 1;
    const std::string way = table > 0 ? fmt::format("table {}/", table) : std::string();
    return opened ? add_rows(*opened, way) : Rows();
  });
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
  const std::optional<std::size_t> names = naming_column(table);
  std::vector<std::optional<std::uint8_t>> properties;
  for (std::size_t i = 0; i < table.columns().size() && rows.count > 0; ++i)
    properties.push_back(i == names ? std::nullopt
                                    : objects_.properties.number(table.columns()[i]));
  for (std::uint64_t row = 0; row < rows.count; ++row) {
    file_.room().check();
    FoundObject object{names ? text_of_value(table.value(*names, row))
                             : fmt::format("{}{}feature {}", prefix_, way, row)};
    if (names && small_letters(table.columns()[*names]) != kNamingColumns[0])
      object.id = object.name;
    else if (prefix_.empty())
      object.id = fmt::format("{}", row);
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

std::optional<std::size_t> GltfFeatures::naming_column(mesh_io::FeatureTable& table) const {
  for (const std::string_view name : kNamingColumns) {
    for (std::size_t i = 0; i < table.columns().size(); ++i) {
      if (small_letters(table.columns()[i]) == name && are_different(table, i))
        return i;
    }
  }
  return std::nullopt;
}

/// Returns whether all values differ, and are more than the numbers of their rows, which those of
/// other files have as well. Compares hashes: two values of one hash only take the column its role.
bool GltfFeatures::are_different(mesh_io::FeatureTable& table, std::size_t column) const {
  file_.require_memory(sizeof(std::uint64_t) * table.rows(), "a table of features");
  std::vector<std::uint64_t> hashes;
  bool are_rows = true;
  hashes.reserve(static_cast<std::size_t>(table.rows()));
  for (std::uint64_t row = 0; row < table.rows(); ++row) {
    const std::string text = text_of_value(table.value(column, row));
    if (text.empty())
      return false;
    are_rows = are_rows && text == fmt::format("{}", row);
    hashes.push_back(storage::checksum(std::as_bytes(std::span(text))));
  }
  std::ranges::sort(hashes);
  return !are_rows && std::ranges::adjacent_find(hashes) == hashes.end();
}

}  // namespace meshhier::importing
