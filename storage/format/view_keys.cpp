#include "storage/format/view_keys.h"

#include "base/number_text.h"
#include "hierarchy/scalar_value.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::storage {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kFarthest = 1e30;  ///< as the page has it: squares and products stay in range
constexpr double kMostStretch = 100, kDeepestLevel = 32;
constexpr std::size_t kMostHidden = 256, kMostPoints = 64, kMostTexts = 100;
constexpr std::size_t kMostObjectBytes = 2000;  ///< longer links are cut by what has them

std::vector<double> doubles_of(const Json& value) {
  return value.get<std::vector<double>>();
}

/// Whether links, which keep twelve digits, write two numbers alike.
bool are_alike(double a, double b) {
  return a == b || fmt::format("{:.11e}", a) == fmt::format("{:.11e}", b);
}

bool are_near(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double n) { return std::abs(n) <= kFarthest; });
}

bool is_apart(const Json& value) {
  const std::vector<double> p = doubles_of(value);
  return p.size() == 6 && are_near(p) &&
         !(are_alike(p[0], p[3]) && are_alike(p[1], p[4]) && are_alike(p[2], p[5]));
}

template <std::size_t Count>
bool has_numbers(const Json& value) {
  return value.size() == Count;
}

bool is_plane(const Json& value) {
  const std::vector<double> p = doubles_of(value);
  return p.size() == 4 && are_near(p) && (p[0] != 0 || p[1] != 0 || p[2] != 0);
}

bool is_box(const Json& value) {
  const std::vector<double> p = doubles_of(value);
  return p.size() == 6 && are_near(p) && p[0] < p[3] && p[1] < p[4] && p[2] < p[5];
}

bool is_storey(const Json& value) {
  const std::vector<double> heights = doubles_of(value);
  return heights.size() == 2 && heights[0] < heights[1];
}

bool are_points(const Json& value) {
  return !value.empty() && value.size() % 3 == 0 && value.size() <= 3 * kMostPoints &&
         are_near(doubles_of(value));
}

bool is_point(const Json& value) {
  return value.size() == 3 && are_points(value);
}

bool are_few(const Json& value) {
  return value.size() <= kMostHidden;
}

bool is_positive(const Json& value) {
  return value.get<double>() > 0;
}

bool is_stretch(const Json& value) {
  return value.get<double>() >= 1 && value.get<double>() <= kMostStretch;
}

bool is_level(const Json& value) {
  const auto level = value.get<double>();
  return level >= 0 && level <= kDeepestLevel && level == std::floor(level);
}

bool is_attribute(const Json& value) {
  const auto& name = value.get_ref<const std::string&>();
  return !name.empty() && name.size() <= kMostNameBytes;
}

bool is_text(const Json& value) {
  const auto& text = value.get_ref<const std::string&>();
  return !text.empty() && text.size() <= kMostObjectBytes;
}

bool are_texts(const Json& value) {
  return value.size() <= kMostTexts && std::all_of(value.begin(), value.end(), is_text);
}

const std::vector<std::string> kLights = {"auto", "studio", "raking", "relief",
                                          "flat", "sun",    "matcap"};

/// Whether it is a name alone, or with two angles.
bool is_light(const Json& value) {
  const auto& text = value.get_ref<const std::string&>();
  const std::size_t end = std::min(text.find(','), text.size());
  if (std::ranges::find(kLights, text.substr(0, end)) == kLights.end())
    return false;
  if (end == text.size())
    return true;
  const auto key = parse_numbers(std::string_view(text).substr(end + 1));
  return key && key->size() == 2 && std::ranges::all_of(*key, [](double angle) {
           return std::abs(angle) <= std::numbers::pi;
         });
}

// ---- schemas

Json flag_schema() {
  return {{"type", "boolean"}};
}

Json numbers_schema(std::size_t fewest, std::size_t most) {
  return {
      {"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", fewest}, {"maxItems", most}};
}

Json text_schema(std::size_t most) {
  return {{"type", "string"}, {"minLength", 1}, {"maxLength", most}};
}

Json texts_schema() {
  return {{"type", "array"}, {"items", text_schema(kMostObjectBytes)}, {"maxItems", kMostTexts}};
}

// ---- rows

/// What people read of a key, as in ViewKey.
struct Words {
  std::string_view meaning, expected, unset = "none";
};

using IsSound = bool (*)(const Json& value);

ViewKey view_key(std::string_view name, ViewPart part, ViewField field, const Words& words,
                 Json schema, IsSound is_sound = nullptr) {
  return {.name = name,
          .part = part,
          .field = field,
          .meaning = words.meaning,
          .expected = words.expected,
          .unset = words.unset,
          .schema = std::move(schema),
          .is_sound = is_sound};
}

ViewKey flag(std::string_view name, bool ModelView::*field, std::string_view meaning,
             ViewPart part = ViewPart::look) {
  return view_key(name, part, field,
                  {meaning, "true or false", ModelView{}.*field ? "true" : "false"}, flag_schema());
}

ViewKey word(std::string_view name, std::string ModelView::*field, std::vector<std::string> words,
             std::string_view unset, std::string_view meaning, ViewPart part = ViewPart::look) {
  ViewKey made = view_key(name, part, field, {meaning, {}, unset}, {{"enum", words}});
  made.words = std::move(words);
  return made;
}

ViewKey object_text(std::string_view name, std::string ModelView::*field,
                    std::string_view meaning) {
  return view_key(name, ViewPart::objects, field, {meaning, "a text of 1 to 2000 bytes"},
                  text_schema(kMostObjectBytes), is_text);
}

ViewKey object_texts(std::string_view name, std::vector<std::string> ModelView::*field,
                     std::string_view meaning) {
  return view_key(name, ViewPart::objects, field, {meaning, "a list of at most 100 texts"},
                  texts_schema(), are_texts);
}

/// Two numbers.
ViewKey span_of_values(std::string_view name, ViewPart part, std::vector<double> ModelView::*field,
                       std::string_view meaning) {
  return view_key(name, part, field, {meaning, "two numbers", "all values"}, numbers_schema(2, 2),
                  has_numbers<2>);
}

ViewKey light_key() {
  ViewKey made = view_key(
      "light", ViewPart::look, &ModelView::light,
      {"`auto`, `studio`, `raking`, `relief`, `flat`, `sun` or `matcap`; perhaps with two angles "
       "of the key light, to the right and up, in radians: `raking,0.8,0.2`",
       "auto, studio, raking, relief, flat, sun or matcap, perhaps with two angles behind it, "
       "-3.14 to 3.14 each: \"raking,0.8,0.2\"",
       "auto: the sun over terrains, a studio around all else"},
      {{"type", "string"},
       {"pattern", "^(auto|studio|raking|relief|flat|sun|matcap)(,[-+.eE0-9]+){0,2}$"}},
      is_light);
  made.words = kLights;
  return made;
}

std::vector<ViewKey> sight_keys() {
  return {
      view_key(
          "camera", ViewPart::camera, &ModelView::camera,
          {"where the camera is and what it looks at, as in links of the page: input coordinates "
           "less the hierarchy's origin, turned until y is up; `meshhier view --link` takes it "
           "from a link",
           "a place and another one that the camera looks at, three numbers each",
           "all of the model"},
          numbers_schema(6, 6), is_apart),
      word("projection", &ModelView::projection, {"perspective", "parallel"}, "perspective",
           "`parallel`: all depths have one scale, as in drawings", ViewPart::projection),
  };
}

std::vector<ViewKey> look_keys() {
  return {
      word("colours", &ModelView::colours,
           {"plain", "vertex", "partition", "error", "height", "attribute"},
           "vertex; attribute if view.attribute is given",
           "what colours show: `vertex` is the input's own"),
      word("shading", &ModelView::shading, {"smooth", "flat"}, "smooth", "whether triangles show"),
      view_key("attribute", ViewPart::look, &ModelView::attribute,
               {"the attribute of the vertices that colours show", "a name of 1 to 100 bytes",
                "the first one"},
               text_schema(kMostNameBytes), is_attribute),
      word("ramp", &ModelView::ramp, {"viridis", "cividis", "turbo", "coolwarm"}, "viridis",
           "its colours"),
      span_of_values("range", ViewPart::look, &ModelView::range, "values at the ends of the ramp"),
      view_key("tolerance", ViewPart::look, &ModelView::tolerance,
               {"values no farther from 0 are drawn as one neutral band", "a number above 0"},
               {{"type", "number"}, {"exclusiveMinimum", 0}}, is_positive),
      view_key("hidden", ViewPart::look, &ModelView::hidden,
               {"labels that are not drawn", "a list of at most 256 numbers"},
               numbers_schema(0, kMostHidden), are_few),
      flag("texture", &ModelView::texture, "pictures are shown"),
      flag("relight", &ModelView::relight, "pictures that have their light already are lit"),
      flag("cavities", &ModelView::cavities, "hollows are darker, edges lighter"),
      flag("wires", &ModelView::wires, "edges of triangles are drawn"),
      flag("points", &ModelView::points, "vertices are drawn"),
      flag("outline", &ModelView::outline, "the shape-outline is drawn"),
      flag("isolines", &ModelView::isolines, "lines of equal value are drawn"),
      light_key(),
      flag("occlusion", &ModelView::occlusion, "hollows of what is seen get less light"),
  };
}

/// How the model stands, and what of it is shown.
std::vector<ViewKey> space_keys() {
  return {
      word("up", &ModelView::up, {"file", "x", "y", "z", "-x", "-y", "-z"},
           "file: as the key up says", "the axis of the input that is shown upright",
           ViewPart::standing),
      view_key("stretch", ViewPart::standing, &ModelView::stretch,
               {"heights are shown so many times as high", "a number from 1 to 100", "1"},
               {{"type", "number"}, {"minimum", 1}, {"maximum", kMostStretch}}, is_stretch),
      word("dollhouse", &ModelView::dollhouse, {"auto", "on", "off"},
           "auto: where most of the hull looks away",
           "whether faces that look away are left out, to look into rooms", ViewPart::dollhouse),
      view_key("level", ViewPart::level, &ModelView::level,
               {"the finest level that is shown; the root is 0", "an integer from 0 to 32",
                "the last one"},
               {{"type", "integer"}, {"minimum", 0}, {"maximum", kDeepestLevel}}, is_level),
      view_key(
          "cut", ViewPart::cut, &ModelView::cut,
          {"`[a, b, c, d]`, in input coordinates: shown is where ax + by + cz + d is at least 0",
           "four numbers, the first three not all 0"},
          numbers_schema(4, 4), is_plane),
      view_key("box", ViewPart::cut, &ModelView::box,
               {"two corners, in input coordinates: what lies between them is shown",
                "two corners, each number of the first below that of the second"},
               numbers_schema(6, 6), is_box),
      flag("caps", &ModelView::caps, "cuts of closed models are closed", ViewPart::cut),
      view_key("storey", ViewPart::rooms, &ModelView::storey,
               {"heights of the input: what lies between them is shown",
                "two numbers, the lower one first", "all"},
               numbers_schema(2, 2), is_storey),
  };
}

std::vector<ViewKey> point_keys() {
  return {
      view_key("measure", ViewPart::measure, &ModelView::measure,
               {"points that are measured, three numbers each, in input coordinates",
                "1 to 64 points, three numbers each"},
               numbers_schema(3, 3 * kMostPoints), are_points),
      view_key("pick", ViewPart::pick, &ModelView::pick,
               {"the point that is picked, in input coordinates", "three numbers"},
               numbers_schema(3, 3), is_point),
  };
}

std::vector<ViewKey> object_view_keys() {
  return {
      object_text("object", &ModelView::object, "the object that is picked, by its name"),
      object_text("by", &ModelView::by, "the property that objects are coloured by"),
      span_of_values("between", ViewPart::objects, &ModelView::between,
                     "its values at the ends of the ramp"),
      object_texts("only", &ModelView::only, "objects that are shown, and no others"),
      object_texts("hide", &ModelView::hide, "objects that are not shown"),
      object_texts("show", &ModelView::show,
                   "objects that are shown although others of theirs are not"),
  };
}

std::vector<ViewKey> make_keys() {
  std::vector<ViewKey> all;
  for (const auto make : {sight_keys, look_keys, space_keys, point_keys, object_view_keys})
    std::ranges::move(make(), std::back_inserter(all));
  return all;
}

/// Whether a JSON is of the member's type.
bool has_type(const ViewField& field, const Json& value) {
  const auto are = [&](bool (*is)(const Json&)) {
    return value.is_array() && std::all_of(value.begin(), value.end(), is);
  };
  const auto is_number = [](const Json& one) {
    return one.is_number() && std::isfinite(one.get<double>());
  };
  const auto is_string = [](const Json& one) { return one.is_string(); };
  constexpr std::size_t kFlag = 0, kText = 1, kNumber = 2, kNumbers = 3;
  switch (field.index()) {
    case kFlag:
      return value.is_boolean();
    case kText:
      return value.is_string();
    case kNumber:
      return is_number(value);
    case kNumbers:
      return are(is_number);
    default:
      return are(is_string);
  }
}

bool is_empty(bool) {
  return false;
}
bool is_empty(const std::optional<double>& value) {
  return !value;
}
template <class List>
bool is_empty(const List& list) {
  return list.empty();
}

Json json_of(const std::optional<double>& value) {
  return *value == std::trunc(*value) && std::abs(*value) < 1e15
             ? Json(static_cast<std::int64_t>(*value))
             : Json(*value);
}
template <class Value>
Json json_of(const Value& value) {
  return value;
}

/// Takes what has its default away: links do not have it.
void settle(ModelView& view) {
  if (view.stretch == 1)
    view.stretch.reset();
}

}  // namespace

std::span<const ViewKey> view_keys() {
  static const std::vector<ViewKey> keys = make_keys();
  return keys;
}

const ViewKey* find_view_key(std::string_view name) {
  const auto found = std::ranges::find(view_keys(), name, &ViewKey::name);
  return found == view_keys().end() ? nullptr : &*found;
}

std::string expectation(const ViewKey& key) {
  if (!key.expected.empty())
    return std::string(key.expected);
  return fmt::format("one of \"{}\"", fmt::join(key.words, "\", \""));
}

bool accepts(const ViewKey& key, const Json& value) {
  if (!has_type(key.field, value))
    return false;
  if (key.is_sound != nullptr)
    return key.is_sound(value);
  return key.words.empty() ||
         std::ranges::find(key.words, value.get_ref<const std::string&>()) != key.words.end();
}

void assign(const ViewKey& key, const Json& value, ModelView& view) {
  std::visit(
      [&](auto field) {
        using Value = std::remove_reference_t<decltype(view.*field)>;
        if constexpr (std::is_same_v<Value, std::optional<double>>)
          view.*field = value.get<double>();
        else
          view.*field = value.get<Value>();
      },
      key.field);
  settle(view);
}

Json value_json(const ViewKey& key, const ModelView& view) {
  return std::visit(
      [&](auto field) {
        // Colours beside an attribute are told: without them they would be the attribute's.
        const bool is_needed = key.name == "colours" && !view.attribute.empty();
        const bool is_default = view.*field == ModelView{}.*field || is_empty(view.*field);
        return is_default && !is_needed ? Json() : json_of(view.*field);
      },
      key.field);
}

std::optional<ViewProblem> problem_between_keys(const ModelView& view) {
  if (!view.cut.empty() && !view.box.empty())
    return ViewProblem{"box", "\"cut\" or \"box\", not both"};
  if (const std::size_t bytes = json_text(view_json(view), {.throws = true}).size();
      bytes > kMostViewBytes)
    return ViewProblem{"", fmt::format("at most {} bytes in all, found {}: name fewer objects",
                                       kMostViewBytes, bytes)};
  return std::nullopt;
}

std::variant<ModelView, ViewProblem> parse_view(const Json& json) {
  if (!json.is_object())
    return ViewProblem{"", "an object"};
  ModelView view;
  for (const auto& [name, value] : json.items()) {
    const ViewKey* key = find_view_key(name);
    if (key == nullptr)
      return ViewProblem{name, "a key of views, which this is not"};
    if (!accepts(*key, value))
      return ViewProblem{name, expectation(*key)};
    assign(*key, value, view);
  }
  if (json.contains("attribute") && !json.contains("colours"))
    view.colours = "attribute";
  if (auto problem = problem_between_keys(view))
    return *problem;
  return view;
}

Json view_json(const ModelView& view) {
  Json json = Json::object();
  for (const ViewKey& key : view_keys()) {
    if (Json value = value_json(key, view); !value.is_null())
      json[std::string(key.name)] = std::move(value);
  }
  return json;
}

}  // namespace meshhier::storage
