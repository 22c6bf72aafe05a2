#include "storage/format/view_link.h"

#include "base/number_text.h"
#include "base/percent_code.h"
#include "base/utf8.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kCamera = "camera";
constexpr std::size_t kMostLinkTexts = 100;
constexpr int kLinkDigits = 12, kAngleDigits = 4;

// ---- reading

/// Decodes a name or value as pages do (WHATWG URL, application/x-www-form-urlencoded): a % that is
/// followed by no two digits stays.
std::string decoded(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto escaped = text[i] == '%' ? percent_decoded(text.substr(i, 3)) : std::nullopt;
    bytes += escaped ? *escaped : std::string(1, text[i] == '+' ? ' ' : text[i]);
    i += escaped ? 2 : 0;
  }
  return sound_utf8(bytes);
}

using Values = std::vector<std::string>;  ///< of one name, as often as it is there

Json flag_json(const std::string& text) {
  return text == "on" ? Json(true) : text == "off" ? Json(false) : Json();
}

/// Returns the values of a key as a JSON has them; null if they cannot be.
Json typed(const ViewField& field, const Values& values) {
  constexpr std::size_t kFlag = 0, kText = 1, kNumber = 2, kNumbers = 3;
  const std::string& first = values.front();
  switch (field.index()) {
    case kFlag:
      return flag_json(first);
    case kText:
      return first;
    case kNumber: {
      const auto numbers = parse_numbers(first);
      return numbers && numbers->size() == 1 ? Json(numbers->front()) : Json();
    }
    case kNumbers: {
      const auto numbers = parse_numbers(first);
      return numbers ? Json(*numbers) : Json();
    }
    default:
      return Values(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(
                                                         std::min(values.size(), kMostLinkTexts)));
  }
}

/// Returns whether the values say anything: nothing at all says that there is nothing of the part.
bool take_values(const ViewKey& key, const Values& values, ModelView& view) {
  const Json value = typed(key.field, values);
  // "studio,9,9": the word can be read, what is behind it cannot.
  const Json word = values.front().substr(0, values.front().find(','));
  if (accepts(key, value))
    assign(key, value, view);
  else if (!key.words.empty() && accepts(key, word))
    assign(key, word, view);
  else
    return values.front().empty();
  return true;
}

// ---- writing

/// Returns a number of so many digits as JavaScript writes it, but for the + of an exponent, which
/// would be a space.
std::string number_text(double number, int digits) {
  const double rounded = std::strtod(fmt::format("{:.{}e}", number, digits - 1).c_str(), nullptr);
  const double size = std::abs(rounded);
  if (size == 0)
    return "0";
  if (size >= 1e-6 && size < 1e21) {
    char text[400];
    const auto end = std::to_chars(text, text + sizeof text, rounded, std::chars_format::fixed).ptr;
    return {text, end};
  }
  char text[40];
  const auto end =
      std::to_chars(text, text + sizeof text, rounded, std::chars_format::scientific).ptr;
  const std::string_view all(text, static_cast<std::size_t>(end - text));
  const std::size_t e = all.find('e');
  return fmt::format("{}e{}", all.substr(0, e), std::atoi(text + e + 1));
}

std::string numbers_text(std::span<const double> numbers, int digits) {
  std::vector<std::string> texts;
  for (const double number : numbers)
    texts.push_back(number_text(number, digits));
  return fmt::format("{}", fmt::join(texts, ","));
}

/// Returns a word with numbers behind it: those are angles; any other text as it is, escaped.
std::string word_text(const ViewKey& key, const std::string& text) {
  const std::size_t end = text.find(',');
  const auto angles = key.words.empty() || end == std::string::npos
                          ? std::nullopt
                          : parse_numbers(std::string_view(text).substr(end + 1));
  return angles ? text.substr(0, end) + ',' + numbers_text(*angles, kAngleDigits)
                : percent_encoded(text);
}

struct Written {
  const ViewKey& key;
  std::string operator()(const Json& value) const {
    if (value.is_boolean())
      return value.get<bool>() ? "on" : "off";
    if (value.is_number())
      return number_text(value.get<double>(), kLinkDigits);
    if (value.is_string())
      return word_text(key, value.get<std::string>());
    return numbers_text(value.get<std::vector<double>>(), kLinkDigits);
  }
};

/// Returns what a link has of a key that has not its default.
std::string part_of(const ViewKey& key, const Json& value, const ModelView& view) {
  if (key.name == kCamera)
    return '&' + Written{key}(value);
  if (key.name == "colours" && view.colours == ModelView{}.colours)
    return "";
  if (!value.is_array() || value.empty() || !value.front().is_string())
    return fmt::format("&{}={}", key.name, Written{key}(value));
  std::string parts;
  for (const Json& text : value)
    parts += fmt::format("&{}={}", key.name, percent_encoded(text.get<std::string>()));
  return parts;
}

}  // namespace

std::optional<ViewLink> parse_view_link(std::string_view link) {
  const std::size_t hash = link.find('#');
  if (hash == std::string_view::npos)
    return std::nullopt;
  ViewLink read;
  std::map<std::string, Values, std::less<>> given;
  std::string_view camera;
  std::string_view left = link.substr(std::min(link.find('&', hash), link.size()));
  while (!left.empty()) {
    left.remove_prefix(1);
    const std::string_view part = left.substr(0, left.find('&'));
    left.remove_prefix(part.size());
    const std::size_t equals = part.find('=');
    if (equals != std::string_view::npos)
      given[decoded(part.substr(0, equals))].push_back(decoded(part.substr(equals + 1)));
    else if (camera.empty())
      camera = part;
  }
  given.erase(std::string(kCamera));
  if (!camera.empty())
    given[std::string(kCamera)] = {std::string(camera)};
  for (const ViewKey& key : view_keys()) {
    const auto found = given.find(key.name);
    if (found == given.end())
      continue;
    if (take_values(key, found->second, read.view))
      read.said.insert(key.part);
  }
  if (const auto problem = problem_between_keys(read.view); problem && problem->key == "box")
    read.view.box.clear();
  for (const auto& [name, values] : given) {
    if (find_view_key(name) == nullptr)
      read.others.push_back(name);
  }
  return read;
}

ModelView over_first(const ViewLink& link, const ModelView& first) {
  ModelView view = link.view;
  for (const ViewKey& key : view_keys()) {
    if (!link.said.contains(key.part))
      std::visit([&](auto field) { view.*field = first.*field; }, key.field);
  }
  // A camera is kept in the world of its own standing.
  const bool stands_so = view.up == first.up && view.stretch == first.stretch;
  if (!link.said.contains(ViewPart::camera) && !stands_so)
    view.camera.clear();
  return view;
}

std::string view_link(const ModelView& view) {
  std::string link;
  for (const ViewKey& key : view_keys()) {
    if (const Json value = value_json(key, view); !value.is_null())
      link += part_of(key, value, view);
  }
  return link;
}

}  // namespace meshhier::storage
