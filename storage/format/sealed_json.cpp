#include "storage/format/sealed_json.h"

#include "base/error.h"
#include "hierarchy/attributes.h"
#include "storage/format/glb.h"
#include "storage/io/file.h"
#include "storage/io/hash.h"
#include "storage/io/json_text.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kBeforeSeal = ",\n  \"checksum\": \"";
constexpr std::string_view kAfterSeal = "\"\n}\n";
constexpr std::size_t kDigits = 16;
constexpr std::string_view kZeros = "0000000000000000";

std::uint64_t text_checksum(const std::string& text) {
  return checksum(std::as_bytes(std::span(text)));
}

std::optional<double> finite(const Json& value) {
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    return std::nullopt;
  return value.get<double>();
}

/// Must come before anything else is asked of the document: a newer format may differ in all the
/// rest.
void check_version(const JsonObject& object, const SealedFormat& format) {
  if (object.text("format") != format.name)
    object.wrong("format", fmt::format("\"{}\"", format.name));
  const std::uint64_t version = object.count("format_version");
  const auto known = static_cast<std::uint64_t>(format.version);
  if (version > known) {
    object.fail(
        fmt::format("format version {} is newer than {}, the newest known: use a newer meshhier",
                    version, known));
  }
  const std::uint64_t oldest = known - static_cast<std::uint64_t>(format.older_versions);
  if (version < oldest) {
    object.fail(fmt::format(
        "was made with format version {}, this program reads {}: {}", version,
        oldest == known ? fmt::format("{}", known) : fmt::format("{} to {}", oldest, known),
        format.way_out));
  }
}

void check_seal(const std::string& text, const JsonObject& object) {
  const std::size_t tail = kBeforeSeal.size() + kDigits + kAfterSeal.size();
  const std::uint64_t expected = object.hash("checksum");
  const bool ends = text.size() >= tail && text.ends_with(kAfterSeal) &&
                    text.compare(text.size() - tail, kBeforeSeal.size(), kBeforeSeal) == 0;
  if (!ends)
    object.fail("does not end with its checksum: the file was changed");
  std::string zeroed = text;
  zeroed.replace(text.size() - kAfterSeal.size() - kDigits, kDigits, kZeros);
  if (text_checksum(zeroed) != expected) {
    object.fail(fmt::format("checksum is {}, expected {}: the file was changed",
                            hex_digits(text_checksum(zeroed)), hex_digits(expected)));
  }
}

/// Whether manifests say of a kind if there is one: of other kinds than these only if there is.
constexpr bool is_always_told(AttributeKind kind) {
  return kind == AttributeKind::normals || kind == AttributeKind::texcoords;
}
/// Pictures are told of elsewhere.
constexpr bool is_flag(const AttributeKindRow& row) {
  return row.flag != nullptr && row.kind != AttributeKind::material;
}

}  // namespace

std::string sealed_text(const SealedFormat& format, const Json& document) {
  Json sealed;
  sealed["format"] = format.name;
  sealed["format_version"] = format.version;
  sealed.update(document);
  sealed["checksum"] = kZeros;
  // A file name need not be UTF-8, but JSON must be: the writer replaces the rest by U+FFFD.
  std::string text = json_text(sealed, {.indent = 2});
  text += '\n';
  const std::uint64_t sum = text_checksum(text);
  text.replace(text.size() - kAfterSeal.size() - kDigits, kDigits, hex_digits(sum));
  return text;
}

std::string read_sealed_text(const File& file, std::size_t most_bytes) {
  const std::vector<std::byte> bytes = read_file(file, most_bytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Json parse_sealed(const std::string& text, const SealedFormat& format, const std::string& name) {
  if (text.size() > format.most_bytes) {
    throw Error(ErrorCode::corrupt, fmt::format("{}: has {} bytes, expected at most {}", name,
                                                text.size(), format.most_bytes));
  }
  Json document = parse_json(text, name);
  const JsonObject object(document, "", name);
  if (!document.is_object())
    object.fail("is not a JSON object");
  check_version(object, format);
  check_seal(text, object);
  return document;
}

void JsonObject::fail(const std::string& what) const {
  throw Error(ErrorCode::corrupt, name_ + ": " + what);
}

void JsonObject::wrong(const char* key, const std::string& expected) const {
  fail(fmt::format("\"{}{}\" is wrong, expected {}", path_, key, expected));
}

const Json& JsonObject::at(const char* key) const {
  const auto found = json_.find(key);
  if (found == json_.end())
    fail(fmt::format("\"{}{}\" is missing", path_, key));
  return *found;
}

std::vector<std::string> JsonObject::keys() const {
  std::vector<std::string> all;
  for (const auto& item : json_.items())
    all.push_back(item.key());
  return all;
}

JsonObject JsonObject::object(const char* key) const {
  if (!at(key).is_object())
    wrong(key, "an object");
  return {at(key), path_ + key + ".", name_};
}

std::vector<JsonObject> JsonObject::objects(const char* key) const {
  if (!at(key).is_array())
    wrong(key, "an array");
  std::vector<JsonObject> all;
  for (const Json& item : at(key)) {
    if (!item.is_object())
      wrong(key, "an array of objects");
    all.emplace_back(item, path_ + key + ".", name_);
  }
  return all;
}

std::uint64_t JsonObject::count(const char* key, std::uint64_t max) const {
  const Json& value = at(key);
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > max) {
    wrong(key, fmt::format("an integer from 0 to {}", max));
  }
  return value.get<std::uint64_t>();
}

std::uint32_t JsonObject::short_count(const char* key) const {
  return static_cast<std::uint32_t>(count(key, UINT32_MAX));
}

bool JsonObject::boolean(const char* key) const {
  if (!at(key).is_boolean())
    wrong(key, "true or false");
  return at(key).get<bool>();
}

std::vector<std::string> JsonObject::texts(const char* key) const {
  const Json& value = at(key);
  const auto is_text = [](const Json& one) { return one.is_string(); };
  if (!value.is_array() || !std::ranges::all_of(value, is_text))
    wrong(key, "an array of texts");
  return value.get<std::vector<std::string>>();
}

std::string JsonObject::text(const char* key) const {
  if (!at(key).is_string())
    wrong(key, "a text");
  return at(key).get<std::string>();
}

double JsonObject::number(const char* key) const {
  const auto value = finite(at(key));
  if (!value)
    wrong(key, "a number");
  return *value;
}

Vec3d JsonObject::point(const char* key) const {
  const Json& value = at(key);
  if (!value.is_array() || value.size() != 3)
    wrong(key, "three numbers");
  const auto x = finite(value[0]);
  const auto y = finite(value[1]);
  const auto z = finite(value[2]);
  if (!x || !y || !z)
    wrong(key, "three numbers");
  return {*x, *y, *z};
}

std::optional<Transform> JsonObject::transform_or_null(const char* key) const {
  const Json& value = at(key);
  if (value.is_null())
    return std::nullopt;
  Transform transform{};
  bool fits = value.is_array() && value.size() == transform.size();
  for (std::size_t i = 0; fits && i < transform.size(); ++i) {
    const auto number = finite(value[i]);
    fits = number.has_value();
    transform[i] = number.value_or(0);
  }
  if (!fits)
    wrong(key, "null or 16 numbers");
  return transform;
}

std::uint64_t JsonObject::hash(const char* key) const {
  const std::string digits = text(key);
  const bool fits =
      digits.size() == kDigits && digits.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!fits)
    wrong(key, "16 hexadecimal digits");
  return std::stoull(digits, nullptr, 16);
}

AttributeLayout JsonObject::attributes(const char* key) const {
  const JsonObject from = object(key);
  AttributeLayout attributes;
  for (const AttributeKindRow& row : kAttributeKinds) {
    if (is_flag(row) && (is_always_told(row.kind) || from.has(row.name.data())))
      attributes.*row.flag = from.boolean(row.name.data());
  }
  attributes.alpha = from.boolean("alpha");
  if (from.has("linear_colours") && from.boolean("linear_colours"))
    attributes.space = ColourSpace::linear;
  attributes.tints = from.has("tints") && from.boolean("tints");
  const auto colours = value_named(kColourTypes, from.text("colours"));
  if (!colours)
    from.wrong("colours", "one of " + names_in(kColourTypes));
  attributes.colour = *colours;
  if (attributes.alpha && !attributes.has_colours())
    from.wrong("alpha", "false without colours");
  if (attributes.tints && !attributes.has_colours())
    from.wrong("tints", "false without colours");
  return attributes;
}

UpAxis JsonObject::up(const char* key) const {
  const std::string axis = text(key);
  if (axis != name_of(UpAxis::y) && axis != name_of(UpAxis::z))
    wrong(key, "\"y\" or \"z\"");
  return axis == name_of(UpAxis::z) ? UpAxis::z : UpAxis::y;
}

std::string hex_digits(std::uint64_t value) {
  return fmt::format("{:016x}", value);
}

Json point_json(Vec3d point) {
  return Json::array({point.x, point.y, point.z});
}

Json attributes_json(const AttributeLayout& attributes) {
  Json json;
  for (const AttributeKindRow& row : kAttributeKinds) {
    if (row.kind == AttributeKind::colours) {
      json["colours"] = row_of(attributes.colour).name;
      json["alpha"] = attributes.alpha;
    } else if (is_flag(row) && (is_always_told(row.kind) || attributes.*row.flag)) {
      json[row.name] = attributes.*row.flag;
    }
  }
  if (attributes.space == ColourSpace::linear)
    json["linear_colours"] = true;
  if (attributes.tints)
    json["tints"] = true;
  return json;
}

}  // namespace meshhier::storage
