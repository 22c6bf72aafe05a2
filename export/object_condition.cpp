#include "export/object_condition.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "base/small_letters.h"
#include "config/suggest.h"
#include "export/condition_words.h"
#include "export/object_value.h"
#include "import/property_types.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::exporting {
namespace {

using Truth = ObjectCondition::Truth;
using Test = ObjectCondition::Test;

/// Parentheses and negations within each other: each takes some calls.
constexpr int kMostDepth = 200;
constexpr std::size_t kShownNameBytes = 60;
constexpr std::size_t kShownNames = 12;

/// A value in a row, or of the condition.
using Value = std::variant<std::monostate, double, bool, std::string_view>;

/// In the order of Value.
enum class OperandKind : std::uint8_t { none, number, boolean, text };

std::string_view kind_text(OperandKind kind) {
  return kind == OperandKind::number    ? "a number"
         : kind == OperandKind::boolean ? "a boolean"
                                        : "a text";
}

struct Operand {
  OperandKind kind{};
  std::function<Value(const ObjectRow& row)> value;
  std::string name{};  ///< as it is written
  std::size_t place = 0;
  bool is_literal = false;
};

Operand literal(ConditionWord word, OperandKind kind,
                std::variant<double, bool, std::string> value) {
  const auto get = [value = std::move(value)](const ObjectRow&) {
    return std::visit([](const auto& known) { return Value(known); }, value);
  };
  return {kind, get, std::move(word.text), word.place, true};
}

struct Fact {
  std::string_view name;
  OperandKind kind;
  Value (*value)(const ObjectRow& row);
};
constexpr std::array kFacts{
    Fact{"name", OperandKind::text, [](const ObjectRow& row) { return Value(row.name); }},
    Fact{"area", OperandKind::number, [](const ObjectRow& row) { return Value(row.area); }},
    Fact{"triangles", OperandKind::number,
         [](const ObjectRow& row) { return Value(static_cast<double>(row.triangles)); }}};
constexpr std::string_view kFactPrefix = "object.";

OperandKind kind_of(ObjectPropertyType type) {
  return type == ObjectPropertyType::number    ? OperandKind::number
         : type == ObjectPropertyType::boolean ? OperandKind::boolean
                                               : OperandKind::text;
}

Value operand_value(const ObjectValue& value) {
  return std::visit([](const auto& known) { return Value(known); }, value);
}

Truth truth(bool is_true) {
  return is_true ? Truth::yes : Truth::no;
}
Truth opposite(Truth truth) {
  return static_cast<Truth>(2 - static_cast<int>(truth));
}
Test negated(Test test, bool is_negated) {
  if (!is_negated)
    return test;
  return [test = std::move(test)](const ObjectRow& row) { return opposite(test(row)); };
}

bool is_none(const Value& value) {
  return std::holds_alternative<std::monostate>(value);
}

/// A comparison sign, and whether it holds for less, equal, greater.
struct Comparison {
  std::string_view sign;
  bool less, equal, greater;
};
constexpr std::array kComparisons{
    Comparison{"=", false, true, false}, Comparison{"<>", true, false, true},
    Comparison{"!=", true, false, true}, Comparison{"<", true, false, false},
    Comparison{"<=", true, true, false}, Comparison{">", false, false, true},
    Comparison{">=", false, true, true}};

Test compared(Operand left, const Comparison& comparison, Operand right) {
  return [left = std::move(left.value), right = std::move(right.value),
          comparison](const ObjectRow& row) {
    const Value a = left(row), b = right(row);
    if (is_none(a) || is_none(b))
      return Truth::unknown;
    return truth(a < b ? comparison.less : b < a ? comparison.greater : comparison.equal);
  };
}

/// Joins tests in a row by "and" (no: one decides) or "or" (yes: one decides), however many.
Test joined(std::vector<Test> tests, Truth deciding) {
  if (tests.size() == 1)
    return std::move(tests[0]);
  return [tests = std::move(tests), deciding](const ObjectRow& row) {
    Truth all = opposite(deciding);
    for (const Test& test : tests) {
      const Truth one = test(row);
      if (one == deciding)
        return one;
      all = one == Truth::unknown ? one : all;
    }
    return all;
  };
}

std::string unknown_text(const std::string& name, std::span<const ObjectProperty> properties) {
  std::vector<std::string> names;
  for (const ObjectProperty& property : properties)
    names.push_back(property.name);
  for (const Fact& fact : kFacts)
    names.emplace_back(fact.name);
  const auto near = config::nearest_word(name, names);
  const std::string hint =
      near ? fmt::format(" (did you mean \"{}\"?)", plain_text(*near, kShownNameBytes)) : "";
  const std::size_t more = names.size() - std::min(names.size(), kShownNames);
  names.resize(names.size() - more);
  for (std::string& one : names)
    one = plain_text(one, kShownNameBytes);
  return fmt::format("objects have no \"{}\"{}; there are {}{}", plain_text(name, kShownNameBytes),
                     hint, fmt::join(names, ", "),
                     more > 0 ? fmt::format(" and {} more", more) : "");
}

ObjectValue kept(const Value& value) {
  return std::visit(
      [](const auto& known) -> ObjectValue {
        if constexpr (std::is_same_v<std::decay_t<decltype(known)>, std::string_view>)
          return std::string(known);
        else
          return known;
      },
      value);
}

/// One reading of a condition, by recursive descent.
class Parser {
 public:
  Parser(std::string_view text, std::span<const ObjectProperty> properties)
      : words_(text), properties_(properties) {}

  Test run() {
    Test test = read_or(0);
    if (words_.now().kind != WordKind::end)
      words_.fail_expected("\"and\", \"or\" or the end");
    return test;
  }

 private:
  Test read_or(int depth) {
    std::vector<Test> tests{read_and(depth)};
    while (words_.take_if("or"))
      tests.push_back(read_and(depth));
    return joined(std::move(tests), Truth::yes);
  }

  Test read_and(int depth) {
    std::vector<Test> tests{read_not(depth)};
    while (words_.take_if("and"))
      tests.push_back(read_not(depth));
    return joined(std::move(tests), Truth::no);
  }

  Test read_not(int depth) {
    if (depth > kMostDepth)
      words_.fail(words_.now().place, "parentheses are too deep here");
    if (words_.take_if("not"))
      return negated(read_not(depth + 1), true);
    if (!words_.take_if("("))
      return read_comparison();
    Test test = read_or(depth + 1);
    words_.require(")");
    return test;
  }

  Test read_comparison() {
    Operand left = read_operand();
    const std::size_t place = words_.now().place;
    const auto* const comparison = std::ranges::find_if(
        kComparisons, [&](const Comparison& one) { return words_.now().is(one.sign); });
    if (comparison != kComparisons.end()) {
      words_.take();
      return compare(std::move(left), *comparison, read_operand(), place);
    }
    if (words_.take_if("is")) {
      const bool is_negated = words_.take_if("not");
      words_.require("null");
      return negated([value = std::move(left.value)](
                         const ObjectRow& row) { return truth(is_none(value(row))); },
                     is_negated);
    }
    const bool is_negated = words_.take_if("not");
    if (words_.take_if("in"))
      return negated(read_list(left), is_negated);
    if (words_.take_if("like"))
      return negated(read_pattern(std::move(left), place), is_negated);
    if (words_.take_if("between"))
      return negated(read_between(left, place), is_negated);
    if (is_negated || left.kind != OperandKind::boolean)
      words_.fail_expected("a comparison, \"in\", \"like\", \"between\" or \"is null\"");
    return [value = std::move(left.value)](const ObjectRow& row) {
      const Value known = value(row);
      return is_none(known) ? Truth::unknown : truth(std::get<bool>(known));
    };
  }

  Test compare(Operand left, const Comparison& comparison, Operand right, std::size_t place) {
    if (left.kind != right.kind) {
      words_.fail(place, fmt::format("{} is {}, {} is {}: they cannot be compared", shown(left),
                                     kind_text(left.kind), shown(right), kind_text(right.kind)));
    }
    return compared(std::move(left), comparison, std::move(right));
  }

  Test read_between(const Operand& value, std::size_t place) {
    std::vector<Test> tests{compare(value, kComparisons[6], read_operand(), place)};
    words_.require("and");
    tests.push_back(compare(value, kComparisons[4], read_operand(), place));
    return joined(std::move(tests), Truth::no);
  }

  Test read_pattern(Operand left, std::size_t place) {
    if (left.kind != OperandKind::text)
      words_.fail(place, fmt::format("{} is {}, and only texts are like a pattern", shown(left),
                                     kind_text(left.kind)));
    if (words_.now().kind != WordKind::text)
      words_.fail_expected("a pattern in single quotes");
    return [value = std::move(left.value), pattern = words_.take().text](const ObjectRow& row) {
      const Value known = value(row);
      return is_none(known) ? Truth::unknown
                            : truth(is_like(std::get<std::string_view>(known), pattern));
    };
  }

  /// Reads a list of values, which is sorted: there may be thousands.
  Test read_list(const Operand& left) {
    words_.require("(");
    std::vector<ObjectValue> list;
    do {
      const Operand one = read_operand();
      if (!one.is_literal)
        words_.fail(one.place, "a list has numbers, texts or booleans");
      if (one.kind != left.kind)
        words_.fail(one.place,
                    fmt::format("{} is {}, {} is {}: they cannot be compared", shown(left),
                                kind_text(left.kind), shown(one), kind_text(one.kind)));
      list.push_back(kept(one.value({})));
    } while (words_.take_if(","));
    words_.require(")");
    std::ranges::sort(list);
    return [value = left.value, list = std::move(list)](const ObjectRow& row) {
      const Value known = value(row);
      if (is_none(known))
        return Truth::unknown;
      const auto found = std::ranges::lower_bound(list, known, {}, operand_value);
      return truth(found != list.end() && operand_value(*found) == known);
    };
  }

  Operand read_operand() {
    const bool is_negative = words_.take_if("-");
    if (is_negative && words_.now().kind != WordKind::number)
      words_.fail_expected("a number");
    ConditionWord word = words_.take();
    switch (word.kind) {
      case WordKind::number: {
        const double number = is_negative ? -word.number : word.number;
        return literal(std::move(word), OperandKind::number, number);
      }
      case WordKind::text: {
        std::string text = word.text;
        return literal(std::move(word), OperandKind::text, std::move(text));
      }
      case WordKind::name:
      case WordKind::quoted_name:
        return read_name(std::move(word));
      default:
        words_.fail(word.place,
                    word.kind == WordKind::end
                        ? "expected a property or a value, but it ends"
                        : fmt::format("expected a property or a value, found {}", word.text));
    }
  }

  Operand read_name(ConditionWord word) {
    if (word.is("true") || word.is("false")) {
      const bool is_true = word.is("true");
      return literal(std::move(word), OperandKind::boolean, is_true);
    }
    if (word.is("null"))
      words_.fail(word.place, "what has no value is found by \"is null\"");
    if ((word.is("date") || word.is("timestamp")) && words_.take_if("("))
      return read_date();
    return known(std::move(word));
  }

  /// Reads DATE('2031-05-17'), as CQL2 has dates.
  Operand read_date() {
    if (words_.now().kind != WordKind::text)
      words_.fail_expected("a date in single quotes");
    ConditionWord word = words_.take();
    if (!importing::is_date(word.text))
      words_.fail(word.place, fmt::format("'{}' is no date, as '2031-05-17' is",
                                          plain_text(word.text, kShownNameBytes)));
    words_.require(")");
    std::string text = word.text;
    return literal(std::move(word), OperandKind::text, std::move(text));
  }

  Operand known(ConditionWord word) {
    const auto property = find_property(word);
    if (property) {
      const auto get = [at = *property](const ObjectRow& row) {
        return operand_value(row.values[at]);
      };
      return {kind_of(properties_[*property].type), get, std::move(word.text), word.place};
    }
    std::string_view name = word.text;
    if (name.starts_with(kFactPrefix))
      name.remove_prefix(kFactPrefix.size());
    const bool is_quoted = word.kind == WordKind::quoted_name;
    const auto* const fact =
        std::ranges::find(kFacts, is_quoted ? std::string(name) : small_letters(name), &Fact::name);
    if (fact == kFacts.end())
      words_.fail(word.place,
                  unknown_text(word.text, properties_) + "; texts stand in single quotes");
    return {fact->kind, fact->value, std::move(word.text), word.place};
  }

  /// Finds the property of that very name; a word without quotes in any letters, if it is one's.
  std::optional<std::size_t> find_property(const ConditionWord& word) const {
    const auto number_of = [&](auto found) {
      return static_cast<std::size_t>(found - properties_.begin());
    };
    const auto same = std::ranges::find(properties_, word.text, &ObjectProperty::name);
    if (same != properties_.end())
      return number_of(same);
    const auto is_alike = [small = small_letters(word.text)](const ObjectProperty& property) {
      return small_letters(property.name) == small;
    };
    const auto alike = std::ranges::find_if(properties_, is_alike);
    if (word.kind != WordKind::name || alike == properties_.end())
      return std::nullopt;
    const auto other = std::find_if(alike + 1, properties_.end(), is_alike);
    if (other != properties_.end()) {
      words_.fail(word.place,
                  fmt::format("\"{}\" and \"{}\" differ in the case of letters alone: write the "
                              "one that is meant as it is",
                              plain_text(alike->name, kShownNameBytes),
                              plain_text(other->name, kShownNameBytes)));
    }
    return number_of(alike);
  }

  static std::string shown(const Operand& operand) {
    const std::string name = plain_text(operand.name, kShownNameBytes);
    return operand.is_literal && operand.kind == OperandKind::text ? "'" + name + "'" : name;
  }

  ConditionWords words_;
  std::span<const ObjectProperty> properties_;
};

/// Takes a character of UTF-8 away.
void drop_character(std::string_view& text) {
  do {
    text.remove_prefix(1);
  } while (!text.empty() && (static_cast<unsigned char>(text[0]) & 0xC0U) == 0x80U);
}

}  // namespace

ObjectCondition::ObjectCondition(std::string_view text, std::span<const ObjectProperty> properties)
    : test_(Parser(text, properties).run()) {}

ObjectValueOf value_named(std::string_view name, std::span<const ObjectProperty> properties) {
  const auto property = std::ranges::find(properties, name, &ObjectProperty::name);
  if (property != properties.end()) {
    const auto at = static_cast<std::size_t>(property - properties.begin());
    return {property->type, [at](const ObjectRow& row) { return row.values[at]; }};
  }
  std::string_view plain = name;
  if (plain.starts_with(kFactPrefix))
    plain.remove_prefix(kFactPrefix.size());
  const auto* const fact = std::ranges::find(kFacts, plain, &Fact::name);
  if (fact == kFacts.end())
    throw Error(ErrorCode::usage, unknown_text(std::string(name), properties));
  const auto type =
      fact->kind == OperandKind::text ? ObjectPropertyType::text : ObjectPropertyType::number;
  return {type, [value = fact->value](const ObjectRow& row) { return kept(value(row)); }};
}

bool is_like(std::string_view text, std::string_view pattern) {
  // Where the last % stood: what comes behind it is tried at each later character.
  std::optional<std::string_view> last_pattern;
  std::string_view last_text;
  while (true) {
    const bool is_plain = pattern.starts_with('\\') && pattern.size() > 1;
    if (!is_plain && pattern.starts_with('%')) {
      pattern.remove_prefix(1);
      last_pattern = pattern;
      last_text = text;
      continue;
    }
    if (pattern.empty() && text.empty())
      return true;
    if (!is_plain && pattern.starts_with('_') && !text.empty()) {
      pattern.remove_prefix(1);
      drop_character(text);
      continue;
    }
    const std::size_t at = is_plain ? 1 : 0;
    if (!pattern.empty() && !text.empty() && pattern[at] == text[0]) {
      pattern.remove_prefix(at + 1);
      text.remove_prefix(1);
      continue;
    }
    if (!last_pattern || last_text.empty())
      return false;
    drop_character(last_text);
    pattern = *last_pattern;
    text = last_text;
  }
}

}  // namespace meshhier::exporting
