#include "config/config_reference.h"

#include "config/config_draft.h"
#include "config/config_schema.h"
#include "hierarchy/image_format.h"
#include "mesh_io/formats.h"
#include "mesh_io/other_formats.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::config {

namespace {

using Json = nlohmann::ordered_json;

/// The texts that parse_size() takes, as a regular expression of JavaScript.
constexpr const char* kSizePattern =
    R"(^[ \t]*[0-9]+(\.[0-9]*)?[ \t]*([bB]|[kKmMgGtT]([iI]?[bB])?)?[ \t]*$)";
/// Columns that a line of the terminal may take.
constexpr std::size_t kLineLength = 96;

std::string with_quotes(std::string text) {
  for (char& letter : text) {
    if (letter == '`')
      letter = '"';
  }
  return text;
}

std::string as_sentence(const std::string& meaning) {
  std::string text = with_quotes(meaning);
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text + '.';
}

/// Returns a number without ".0" if it has no fraction.
Json plain_number(double value) {
  return value == std::trunc(value) ? Json(static_cast<std::int64_t>(value)) : Json(value);
}

// ---- the JSON schema

/// Returns the texts of a choice that begin with its prefix, as a regular expression.
std::string pattern_of(const ConfigKey& key) {
  return fmt::format("{}[!-~]{{1,{}}}", key.prefix, kMostNameBytes);
}

/// Returns the schema of a key's value.
Json value_schema(const ConfigKey& key) {
  const Json path{{"type", "string"}, {"minLength", 1}};
  const Json integer{{"type", "integer"},
                     {"minimum", plain_number(key.minimum)},
                     {"maximum", plain_number(key.maximum)}};
  const auto list = [](const Json& items, auto fewest, auto most) {
    return Json{{"type", "array"}, {"items", items}, {"minItems", fewest}, {"maxItems", most}};
  };
  const auto either = [](const Json& one, const Json& other) {
    return Json{{"oneOf", Json::array({one, other})}};
  };
  switch (key.kind) {
    case KeyKind::text:
      return {{"type", "string"}, {"maxLength", plain_number(key.maximum)}};
    case KeyKind::path:
      return path;
    case KeyKind::paths:
      return either(path, list(path, 1, plain_number(key.maximum)));
    case KeyKind::boolean:
      return {{"type", "boolean"}};
    case KeyKind::integer:
      return integer;
    case KeyKind::number:
      return {{"type", "number"},
              {key.takes_minimum ? "minimum" : "exclusiveMinimum", plain_number(key.minimum)},
              {"maximum", plain_number(key.maximum)}};
    case KeyKind::numbers:
      return list({{"type", "number"}}, plain_number(key.maximum), plain_number(key.maximum));
    case KeyKind::levels:
      return either(integer, list(integer, 1, key.most_levels));
    case KeyKind::size:
      return either(integer, {{"type", "string"}, {"pattern", kSizePattern}});
    case KeyKind::view:
      return key.view->schema;
    case KeyKind::names:
      return either({{"enum", key.choices}}, list(path, 0, plain_number(key.maximum)));
    case KeyKind::choice:
      break;
  }
  const Json choices{{"enum", key.choices}};
  if (key.prefix.empty())
    return choices;
  return {{"anyOf", Json::array({choices, {{"pattern", '^' + pattern_of(key) + '$'}}})}};
}

Json key_schema(const ConfigKey& key) {
  Json schema{{"description", as_sentence(key.meaning)}};
  schema.update(value_schema(key));
  const Json value = key.show(Config{});
  if (!value.is_null())
    schema["default"] = value;
  return schema;
}

/// Returns the rule that there is no key `name`, or one of `others`, too.
Json needs_one(const std::string& name, const std::vector<std::string>& others) {
  Json ways = Json::array({{{"not", {{"required", Json::array({name})}}}}});
  for (const std::string& other : others)
    ways.push_back({{"required", Json::array({other})}});
  return {{"anyOf", ways}};
}

/// Returns the schema of an object, without description. `prefix`: that of its keys' paths, "" or
/// "partition.".
Json object_schema(const std::string& prefix) {
  Json required = Json::array();
  Json rules = Json::array();
  Json needs = Json::object();
  Json properties = Json::object();
  for (const ConfigKey& key : config_keys()) {
    if (!key.path.starts_with(prefix) || key.path.find('.', prefix.size()) != std::string::npos)
      continue;
    const std::string name = key.path.substr(prefix.size());
    properties[name] = key_schema(key);
    if (key.required)
      required.push_back(name);
    for (const std::string& other : key.excludes)
      rules.push_back({{"not", {{"required", Json::array({other, name})}}}});
    if (key.needs.size() == 1)
      needs[name] = key.needs;
    else if (!key.needs.empty())
      rules.push_back(needs_one(name, key.needs));
  }
  for (const ConfigSection& section : config_sections()) {
    if (!section.path.starts_with(prefix) ||
        section.path.find('.', prefix.size()) != std::string::npos)
      continue;
    Json inner{{"description", as_sentence(section.meaning)}};
    inner.update(object_schema(section.path + '.'));
    if (!section.short_for.empty()) {
      const ConfigKey& key = *find_config_key(with_key(section.path, section.short_for));
      inner["type"] = Json::array({"object", "string"});
      inner["pattern"] = fmt::format("^({}|{})$", fmt::join(key.choices, "|"), pattern_of(key));
    }
    properties[section.path.substr(prefix.size())] = inner;
  }
  Json schema{{"type", "object"}, {"additionalProperties", false}};
  if (!required.empty())
    schema["required"] = required;
  if (!rules.empty())
    schema["allOf"] = rules;
  if (!needs.empty())
    schema["dependentRequired"] = needs;
  schema["properties"] = properties;
  return schema;
}

// ---- texts

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// Whether two keys of `section`, which ends in a dot or is empty, exclude each other.
bool exclude_each_other(const ConfigKey& one, const ConfigKey& other, const std::string& section) {
  const auto leaf = [&](const ConfigKey& key) { return key.path.substr(section.size()); };
  return other.path.starts_with(section) &&
         (has(one.excludes, leaf(other)) || has(other.excludes, leaf(one)));
}

/// Returns the meaning, with the keys that it excludes or needs.
std::string whole_meaning(const ConfigKey& key) {
  const std::string section = key.path.substr(0, key.path.rfind('.') + 1);
  std::string text = key.meaning;
  for (const ConfigKey& other : config_keys()) {
    if (exclude_each_other(key, other, section))
      text += fmt::format("; excludes `{}`", other.path);
  }
  std::vector<std::string> needed;
  for (const std::string& name : key.needs)
    needed.push_back('`' + section + name + '`');
  if (!needed.empty())
    text += fmt::format("; needs {}", fmt::join(needed, " or "));
  return text;
}

/// Returns a key's default; if it has none, what holds instead: "required", "none: exact".
std::string default_text(const ConfigKey& key, const char* quote) {
  const Json value = key.show(Config{});
  if (value.is_null())
    return key.required ? "required" : key.unset;
  return quote + storage::json_text(value) + quote;
}

/// Breaks a text between words; each line starts with `indent`.
std::string wrapped(std::string_view text, const std::string& indent) {
  const std::size_t width = kLineLength - indent.size();
  std::string lines;
  while (!text.empty()) {
    const std::size_t space = text.size() <= width ? text.size() : text.rfind(' ', width);
    lines += indent + std::string(text.substr(0, space)) + '\n';
    text.remove_prefix(space == text.size() ? space : space + 1);
  }
  return lines;
}

/// Returns the endings of all kinds of a format, as code of Markdown: "`.gltf`, `.glb`".
std::string endings_of(std::string_view format) {
  std::vector<std::string> all;
  if (format == mesh_io::row_of(mesh_io::MeshKind::tileset).format)
    all.emplace_back("`tileset.json`");  // a name, and no ending
  for (const mesh_io::FormatRow& row : mesh_io::format_rows()) {
    std::string ending = fmt::format("`{}`", row.ending);
    if (row.format == format && !row.ending.empty() && !has(all, ending))
      all.push_back(std::move(ending));
  }
  return fmt::format("{}", fmt::join(all, ", "));
}

/// Returns a value in one line: { "vertices": 8192, "axis": "compactness" }
std::string in_one_line(const Json& value) {
  std::string line;
  for (const char letter : storage::json_text(value, {.indent = 1})) {
    const bool follows_break = !line.empty() && line.back() == ' ';
    if (letter == '\n' || (letter == ' ' && follows_break)) {
      line += follows_break ? "" : " ";
    } else {
      line += letter;
    }
  }
  return line;
}

}  // namespace

std::string schema_text() {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"title", "meshhier build config"},
              {"description",
               "What `meshhier build` makes a hierarchy from, and how. Comments (// and /* */) are "
               "allowed."}};
  schema.update(object_schema(""));
  return storage::json_text(schema, {.indent = 2}) + '\n';
}

std::string keys_text() {
  std::string text =
      "The keys of the config, dotted as for --set. Those with * decide the result; the others\n"
      "never change a byte of it.\n";
  for (const ConfigKey& key : config_keys()) {
    text += fmt::format("\n{} {}: {}; {}{}\n", key.decides_result ? '*' : ' ', key.path,
                        expectation(key), key.required ? "" : "default: ", default_text(key, ""));
    text += wrapped(with_quotes(whole_meaning(key)), "      ");
  }
  return text;
}

std::string keys_markdown() {
  std::string table =
      "| key | value | default | result | meaning |\n"
      "|---|---|---|---|---|\n";
  for (const ConfigKey& key : config_keys())
    table +=
        fmt::format("| `{}` | {} | {} | {} | {} |\n", key.path, expectation(key),
                    default_text(key, "`"), key.decides_result ? "yes" : "no", whole_meaning(key));
  return table;
}

std::string defaults_text() {
  Json defaults{{"input", "david.ply"}, {"output", "david.hier"}};
  for (const ConfigKey& key : config_keys()) {
    Json value = key.show(Config{});
    if (!value.is_null())
      defaults[json_pointer_to(key.path)] = std::move(value);
  }
  std::vector<std::string> lines;
  for (const auto& [name, value] : defaults.items())
    lines.push_back(fmt::format("  \"{}\": {}", name, in_one_line(value)));
  return fmt::format("{{\n{}\n}}\n", fmt::join(lines, ",\n"));
}

std::string formats_text() {
  std::string text =
      "The formats of meshes, each also packed by gzip. What is in a file decides, not its name.\n";
  for (const mesh_io::FormatRow& row : mesh_io::format_rows()) {
    if (row.kept.empty())
      continue;
    text += fmt::format("\n  {}: {}\n", row.format, with_quotes(endings_of(row.format)));
    text += wrapped(with_quotes(fmt::format("kept: {}", row.kept)), "      ");
    text += wrapped(with_quotes(fmt::format("not kept: {}", row.left_out)), "      ");
  }
  return text;
}

std::string formats_markdown() {
  std::string table =
      "| format | files | what is kept | what is not |\n"
      "|---|---|---|---|\n";
  for (const mesh_io::FormatRow& row : mesh_io::format_rows()) {
    if (!row.kept.empty())
      table += fmt::format("| {} | {} | {} | {} |\n", row.format, endings_of(row.format), row.kept,
                           row.left_out);
  }
  return table;
}

std::string formats_json() {
  std::vector<std::string_view> naming, companions;
  for (const mesh_io::FormatRow& row : mesh_io::format_rows()) {
    if (!row.companions.empty())
      naming.push_back(row.ending);
    companions.insert(companions.end(), row.companions.begin(), row.companions.end());
  }
  for (const std::string_view ending : mesh_io::companion_picture_endings())
    companions.push_back(ending);
  Json pictures = Json::array();
  for (const ImageFormatRow& row : kImageFormats)
    pictures.push_back(
        {{"name", row.name}, {"title", row.file.title}, {"type", row.file.media_type}});
  std::vector<std::string_view> shown;
  for (const PictureFile& file : kBrowserPictures)
    shown.push_back(file.media_type);
  const Json formats{{"meshes", mesh_io::mesh_endings()},
                     {"namesOthers", naming},
                     {"companions", companions},
                     {"pictures", pictures},
                     {"browserPictures", shown}};
  return storage::json_text(formats, {.indent = 2}) + '\n';
}

}  // namespace meshhier::config
