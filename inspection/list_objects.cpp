#include "inspection/list_objects.h"

#include "base/plain_text.h"
#include "base/utf8.h"
#include "export/asked_objects.h"
#include "storage/format/archive_files.h"
#include "storage/format/build_name.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/format/object_table.h"
#include "storage/format/object_words.h"
#include "storage/io/json_text.h"

#include <span>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::inspection {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostShownBytes = 200;

Json json_of(const ObjectValue& value) {
  return std::visit(
      [](const auto& known) {
        if constexpr (std::is_same_v<std::decay_t<decltype(known)>, std::monostate>)
          return Json();
        else
          return Json(known);
      },
      value);
}

std::string text_of(const ObjectValue& value) {
  if (const auto* number = std::get_if<double>(&value))
    return fmt::format("{}", *number);  // 7, not 7.0: many are ids and counts
  if (const auto* text = std::get_if<std::string>(&value))
    return plain_text(*text, kMostShownBytes);
  return storage::json_text(json_of(value));
}

std::string json_line(std::uint32_t object, const ObjectRow& row,
                      std::span<const ObjectProperty> properties) {
  Json json = {
      {"object", object}, {"name", row.name}, {"triangles", row.triangles}, {"area", row.area}};
  const auto corner = [](Vec3d p) { return Json::array({p.x, p.y, p.z}); };
  json["box"] =
      row.box ? Json{{"min", corner(row.box->min)}, {"max", corner(row.box->max)}} : Json();
  json["properties"] = Json::object();
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (!std::holds_alternative<std::monostate>(row.values[i]))
      json["properties"][properties[i].name] = json_of(row.values[i]);
  }
  return storage::json_text(json);
}

std::string text_line(std::uint32_t object, const ObjectRow& row,
                      std::span<const ObjectProperty> properties) {
  std::string line = fmt::format("{:>8}  {}  {}, area {:.6g}", object,
                                 row.name.empty() ? "-" : plain_text(row.name, kMostShownBytes),
                                 counted(row.triangles, "triangles"), row.area);
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (!std::holds_alternative<std::monostate>(row.values[i]))
      line += fmt::format(", {} {}", plain_text(properties[i].name, kMostShownBytes),
                          text_of(row.values[i]));
  }
  return line;
}

/// Returns the objects whose names have the words of `text`, ascending. Reads all names where there
/// is no table of words.
std::vector<std::uint32_t> found_objects(const storage::HierarchyReader& reader,
                                         storage::FileSystem& files,
                                         const storage::ObjectTable& table, const std::string& text,
                                         const execution::CancelToken& cancel) {
  const std::string sound = sound_utf8(text);
  const storage::LetterTable letters(storage::kLetterTable, "letters");
  const auto asked = letters.asked_words(sound);
  if (asked.empty())
    throw Error(ErrorCode::usage, "--find: give a word, as 'church mar': \"" +
                                      plain_text(text, kMostShownBytes) + "\" has none");
  if (const auto& words = reader.manifest().objects->words) {
    return storage::of_one_build(files, reader.directory(), reader.manifest(), [&] {
      const auto path = storage::object_words_path(reader.directory());
      return storage::ObjectWords(files.open(path), table.size(), &*words).find(sound);
    });
  }
  std::vector<std::uint32_t> found;
  table.for_each([&](std::uint32_t object, const ObjectRow& row) {
    cancel.check();
    if (storage::fits(letters.words_of(row.name), asked))
      found.push_back(object);
  });
  return found;
}

}  // namespace

void list_objects(storage::FileSystem& files, const std::filesystem::path& directory,
                  const ListedObjects& which, const execution::CancelToken& cancel,
                  const std::function<void(std::string_view)>& visit) {
  const storage::HierarchyFiles place(files, directory);
  const storage::HierarchyReader reader(place.files(), directory);
  const auto table = reader.open_objects();
  exporting::ObjectRequest request{.where = which.where, .prefix = which.prefix};
  if (which.words)
    request.numbers = found_objects(reader, place.files(), *table, *which.words, cancel);
  exporting::for_each_asked(*table, request, cancel,
                            [&](std::uint32_t object, const ObjectRow& row) {
                              visit(which.as_json ? json_line(object, row, table->properties())
                                                  : text_line(object, row, table->properties()));
                            });
}

}  // namespace meshhier::inspection
