#include "import/property_types.h"

#include "base/small_letters.h"
#include "base/trimmed.h"
#include "mesh_io/number_text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using mesh_io::RecordTexts;

bool is_of_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

bool is_nothing(std::string_view text) {
  constexpr std::array<std::string_view, 7> kNothing{"NA",  "N/A",  "#N/A", "NaN",
                                                     "nan", "NULL", "null"};
  return std::ranges::find(kNothing, text) != kNothing.end();
}

std::optional<bool> boolean_of_text(std::string_view text) {
  const std::string small = small_letters(std::string(trimmed(text)));
  return small == "true"    ? std::optional(true)
         : small == "false" ? std::optional(false)
                            : std::nullopt;
}

/// Takes `count` digits that are a number from `least` to `most`.
bool take_number(std::string_view& text, std::size_t count, int least, int most) {
  const std::string_view digits = text.substr(0, count);
  if (digits.size() < count || !is_of_digits(digits))
    return false;
  int number = 0;
  for (const char digit : digits)
    number = number * 10 + (digit - '0');
  text.remove_prefix(count);
  return number >= least && number <= most;
}

bool take_one_of(std::string_view& text, std::string_view letters) {
  if (text.empty() || letters.find(text[0]) == std::string_view::npos)
    return false;
  text.remove_prefix(1);
  return true;
}

/// Takes hours and minutes.
bool take_clock(std::string_view& text, int most_hours) {
  if (!take_number(text, 2, 0, most_hours))
    return false;
  take_one_of(text, ":");
  return take_number(text, 2, 0, 59);
}

/// Takes seconds behind minutes, with a fraction, where they are.
bool take_seconds(std::string_view& text) {
  if (!take_one_of(text, ":"))
    return true;
  if (!take_number(text, 2, 0, 60))
    return false;
  if (!take_one_of(text, ".,"))
    return true;
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  text.remove_prefix(digits);
  return digits > 0;
}

bool is_zone(std::string_view text) {
  if (text.empty() || text == "Z")
    return true;
  return take_one_of(text, "+-") && take_clock(text, 14) && text.empty();
}

ObjectPropertyType type_of_text(std::string_view text, RecordTexts texts) {
  const bool is_plain = texts != RecordTexts::texts;
  if (is_plain && number_of_text(text))
    return ObjectPropertyType::number;
  if (texts == RecordTexts::any_with_commas && number_with_comma(text))
    return ObjectPropertyType::number;
  if (is_plain && boolean_of_text(text))
    return ObjectPropertyType::boolean;
  return is_date(text) ? ObjectPropertyType::date : ObjectPropertyType::text;
}

std::string text_of(const ObjectValue& value) {
  if (const auto* number = std::get_if<double>(&value))
    return fmt::format("{}", *number);
  if (const auto* flag = std::get_if<bool>(&value))
    return *flag ? "true" : "false";
  return std::get<std::string>(value);
}

}  // namespace

std::optional<double> number_of_text(std::string_view text) {
  const std::string_view digits = trimmed(text);
  const std::size_t sign = digits.starts_with('-') || digits.starts_with('+') ? 1 : 0;
  const std::string_view size = digits.substr(std::min(sign, digits.size()));
  const bool is_code = size.size() > 1 && size[0] == '0' && size[1] >= '0' && size[1] <= '9';
  constexpr std::size_t kLongest = 64;
  if (size.empty() || size.size() > kLongest || is_code || digits[0] == '+')
    return std::nullopt;
  const auto number = mesh_io::parse_decimal(digits);
  if (!number || !std::isfinite(number->value))
    return std::nullopt;
  // A whole number that a double does not hold is the number of something, not how many.
  constexpr double kMostWhole = 9007199254740992;  // 2^53
  if (is_of_digits(size) && std::abs(number->value) >= kMostWhole)
    return std::nullopt;
  return number->value;
}

std::optional<double> number_with_comma(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || text.find('.') != std::string_view::npos)
    return std::nullopt;
  std::string number(text);
  number[comma] = '.';
  return number_of_text(number);
}

bool is_date(std::string_view text) {
  const bool has_day = take_number(text, 4, 0, 9999) && take_one_of(text, "-") &&
                       take_number(text, 2, 1, 12) && take_one_of(text, "-") &&
                       take_number(text, 2, 1, 31);
  if (!has_day || text.empty())
    return has_day;
  return take_one_of(text, "T ") && take_clock(text, 24) && take_seconds(text) && is_zone(text);
}

void PropertyTypes::note(std::uint8_t property, const ObjectValue& value, RecordTexts texts) {
  auto type = ObjectPropertyType::number;
  if (std::holds_alternative<std::monostate>(value))
    return;
  if (std::holds_alternative<bool>(value))
    type = ObjectPropertyType::boolean;
  const auto* text = std::get_if<std::string>(&value);
  if (text != nullptr && texts != RecordTexts::texts && is_nothing(*text))
    return;
  if (text != nullptr)
    type = type_of_text(*text, texts);
  if (type == ObjectPropertyType::number && text != nullptr) {
    has_points_[property] = has_points_[property] || text->find('.') != std::string::npos;
    has_commas_[property] = has_commas_[property] || text->find(',') != std::string::npos;
  }
  seen_[property][static_cast<std::size_t>(type)] = true;
}

ObjectPropertyType PropertyTypes::type(std::uint8_t property) const {
  const auto& seen = seen_[property];
  if (std::ranges::count(seen, true) != 1 || (has_points_[property] && has_commas_[property]))
    return ObjectPropertyType::text;
  return static_cast<ObjectPropertyType>(std::ranges::find(seen, true) - seen.begin());
}

ObjectValue PropertyTypes::converted(std::uint8_t property, ObjectValue value) const {
  if (std::holds_alternative<std::monostate>(value))
    return value;
  const auto* text = std::get_if<std::string>(&value);
  if (text != nullptr && type(property) != ObjectPropertyType::text && is_nothing(*text))
    return {};
  switch (type(property)) {
    case ObjectPropertyType::number:
      if (text == nullptr)
        return value;
      return has_commas_[property] && text->find(',') != std::string::npos
                 ? number_with_comma(*text).value()
                 : number_of_text(*text).value();
    case ObjectPropertyType::boolean:
      return text != nullptr ? ObjectValue(boolean_of_text(*text).value()) : value;
    case ObjectPropertyType::text:
    case ObjectPropertyType::date:
      break;
  }
  return text_of(value);
}

}  // namespace meshhier::importing
