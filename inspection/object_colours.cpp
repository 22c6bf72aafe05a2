#include "inspection/object_colours.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "base/srgb.h"
#include "export/object_value.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <utility>
#include <variant>

#include <fmt/format.h>

namespace meshhier::inspection {
namespace {

using exporting::ObjectValueOf;
using storage::ObjectTable;

constexpr std::size_t kMostCategories = 65536;
constexpr std::size_t kShownCategories = 20;
constexpr std::size_t kShownValueBytes = 80;
constexpr float kNoShade = std::numeric_limits<float>::quiet_NaN();

using Categories = std::map<ObjectValue, std::uint32_t>;
using NumberRange = ObjectColours::NumberRange;

NumberRange range_of(const ObjectTable& table, const ObjectValueOf& value,
                     const execution::CancelToken& cancel) {
  NumberRange range;
  table.for_each([&](std::uint32_t, const ObjectRow& row) {
    cancel.check();
    const ObjectValue one = value.get(row);
    if (const auto* number = std::get_if<double>(&one)) {
      range.least = std::min(range.least, *number);
      range.most = std::max(range.most, *number);
    } else {
      ++range.missing;
    }
  });
  return range;
}

Categories categories_of(const ObjectTable& table, const ObjectValueOf& value,
                         const std::string& name, const execution::CancelToken& cancel) {
  Categories counts;
  table.for_each([&](std::uint32_t, const ObjectRow& row) {
    cancel.check();
    ++counts[value.get(row)];
    if (counts.size() > kMostCategories) {
      throw Error(ErrorCode::usage,
                  fmt::format("--colour-by {}: there are more than {} different values, which no "
                              "colours tell apart",
                              plain_text(name, kShownValueBytes), kMostCategories));
    }
  });
  return counts;
}

std::string text_of_category(const ObjectValue& value) {
  if (const auto* flag = std::get_if<bool>(&value))
    return *flag ? "true" : "false";
  const auto* text = std::get_if<std::string>(&value);
  return text == nullptr ? "no value" : plain_text(*text, kShownValueBytes);
}

std::string hex_of(const Vec3f& light) {
  return fmt::format("#{:02x}{:02x}{:02x}", screen_value(double{light.x}),
                     screen_value(double{light.y}), screen_value(double{light.z}));
}

std::string missing_text(std::uint32_t missing) {
  return missing > 0 ? fmt::format("\n  grey     no value ({})", counted(missing, "objects")) : "";
}

}  // namespace

ObjectColours::ObjectColours(const ObjectTable& table, const ObjectColouring& colouring,
                             const execution::CancelToken& cancel) {
  const ObjectValueOf value = exporting::value_named(colouring.property, table.properties());
  is_number_ = value.type == ObjectPropertyType::number;
  shades_.reserve(table.size());
  const auto shade_all = [&](const auto& shade_of) {
    table.for_each([&](std::uint32_t, const ObjectRow& row) {
      cancel.check();
      shades_.push_back(shade_of(value.get(row)));
    });
  };
  if (is_number_) {
    by_numbers(range_of(table, value, cancel), colouring, shade_all);
    return;
  }
  if (colouring.ramp || colouring.range) {
    throw Error(ErrorCode::usage, fmt::format("--ramp and --range are for numbers; {} is none",
                                              plain_text(colouring.property, kShownValueBytes)));
  }
  by_categories(categories_of(table, value, colouring.property, cancel), colouring, shade_all);
}

void ObjectColours::by_numbers(const NumberRange& all, const ObjectColouring& colouring,
                               const ShadeAll& shade_all) {
  const bool is_signed = all.least < 0 && all.most > 0;
  ramp_ = colouring.ramp.value_or(is_signed ? render::ColourRamp::coolwarm
                                            : render::ColourRamp::viridis);
  const double most = std::max(-all.least, all.most);
  const auto [from, to] = colouring.range.value_or(
      ramp_ == render::ColourRamp::coolwarm && is_signed ? std::array{-most, most}
                                                         : std::array{all.least, all.most});
  shade_all([from = from, to = to](const ObjectValue& value) {
    const auto* number = std::get_if<double>(&value);
    if (number == nullptr)
      return kNoShade;
    return from == to ? 0.0F
                      : static_cast<float>(std::clamp((*number - from) / (to - from), 0.0, 1.0));
  });
  const std::string name = plain_text(colouring.property, kShownValueBytes);
  legend_ = all.least > all.most
                ? name + ": no object has a value"
                : fmt::format("{}: from {} ({}) to {} ({})", name, from,
                              hex_of(ramp_colour(ramp_, 0)), to, hex_of(ramp_colour(ramp_, 1)));
  legend_ += missing_text(all.missing);
}

void ObjectColours::by_categories(const Categories& counts, const ObjectColouring& colouring,
                                  const ShadeAll& shade_all) {
  std::vector<std::pair<ObjectValue, std::uint32_t>> sorted(counts.begin(), counts.end());
  std::erase_if(sorted, [](const auto& one) { return one.first == ObjectValue(); });
  std::ranges::stable_sort(sorted, std::greater(), [](const auto& one) { return one.second; });
  std::map<ObjectValue, float> numbers;
  legend_ = plain_text(colouring.property, kShownValueBytes) + ":";
  for (const auto& [value, count] : sorted) {
    const std::size_t number = numbers.size();
    numbers[value] = static_cast<float>(number);
    if (number < kShownCategories)
      legend_ += fmt::format("\n  {}  {} ({})", hex_of(render::label_colour(number)),
                             text_of_category(value), counted(count, "objects"));
  }
  if (sorted.size() > kShownCategories)
    legend_ += fmt::format("\n  and {} more", counted(sorted.size() - kShownCategories, "values"));
  const auto missing = counts.find({});
  legend_ += missing_text(missing == counts.end() ? 0 : missing->second);
  shade_all([&](const ObjectValue& value) {
    const auto known = numbers.find(value);
    return known == numbers.end() ? kNoShade : known->second;
  });
}

std::optional<Vec3f> ObjectColours::colour(double object) const {
  const bool is_known = object >= 0 && object < static_cast<double>(shades_.size());
  const float shade = is_known ? shades_[static_cast<std::size_t>(object)] : kNoShade;
  if (std::isnan(shade))
    return std::nullopt;
  return is_number_ ? render::ramp_colour(ramp_, double{shade})
                    : render::label_colour(static_cast<std::uint64_t>(shade));
}

}  // namespace meshhier::inspection
