#include "export/condition_words.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "base/small_letters.h"
#include "base/utf8.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace meshhier::exporting {
namespace {

constexpr std::size_t kMostConditionBytes = 65536;
constexpr std::size_t kShownWordBytes = 60;
/// The longer ones first.
constexpr std::array<std::string_view, 11> kSigns{"<=", ">=", "<>", "!=", "=", "<",
                                                  ">",  "(",  ")",  ",",  "-"};

constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
/// Letters of other alphabets are bytes above ASCII.
constexpr bool begins_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}
constexpr bool continues_name(char c) {
  return begins_name(c) || is_digit(c) || c == '.' || c == ':';
}
constexpr bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

}  // namespace

bool ConditionWord::is(std::string_view word) const {
  return kind == WordKind::sign ? text == word
                                : kind == WordKind::name && small_letters(text) == word;
}

ConditionWords::ConditionWords(std::string_view text) : text_(text) {
  if (text.size() > kMostConditionBytes)
    throw Error(ErrorCode::usage,
                fmt::format("a condition has {} bytes at most", kMostConditionBytes));
  if (!is_utf8(text))
    throw Error(ErrorCode::usage, "the condition is no UTF-8");
  read();
}

void ConditionWords::fail(std::size_t place, const std::string& what) const {
  const auto before = text_.substr(0, place);
  const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; };
  throw Error(ErrorCode::usage,
              fmt::format("at character {}: {}", 1 + std::ranges::count_if(before, begins), what));
}

void ConditionWords::fail_expected(const std::string& what) const {
  fail(now_.place,
       now_.kind == WordKind::end
           ? fmt::format("expected {}, but it ends", what)
           : fmt::format("expected {}, found {}", what, plain_text(now_.text, kShownWordBytes)));
}

ConditionWord ConditionWords::take() {
  ConditionWord word = std::move(now_);
  read();
  return word;
}

bool ConditionWords::take_if(std::string_view word) {
  const bool is_there = now_.is(word);
  if (is_there)
    read();
  return is_there;
}

void ConditionWords::require(std::string_view word) {
  if (!take_if(word))
    fail_expected(fmt::format("\"{}\"", word));
}

void ConditionWords::read() {
  while (at_ < text_.size() && is_space(text_[at_]))
    ++at_;
  now_ = {.place = at_};
  if (at_ == text_.size())
    return;
  const char first = text_[at_];
  if (first == '\'' || first == '"')
    return read_quoted(first);
  if (is_digit(first) || first == '.')
    return read_number();
  if (!begins_name(first))
    return read_sign();
  const auto* const end = std::find_if_not(text_.begin() + at_, text_.end(), continues_name);
  now_.kind = WordKind::name;
  now_.text = std::string(text_.begin() + at_, end);
  at_ += now_.text.size();
}

/// Two quotes within stand for one.
void ConditionWords::read_quoted(char quote) {
  now_.kind = quote == '"' ? WordKind::quoted_name : WordKind::text;
  for (++at_;; ++at_) {
    const std::size_t end = text_.find(quote, at_);
    if (end == std::string_view::npos)
      fail(now_.place, fmt::format("the {} that begins here has no end",
                                   quote == '"' ? "name in double quotes" : "text"));
    now_.text += text_.substr(at_, end - at_);
    at_ = end + 1;
    if (at_ == text_.size() || text_[at_] != quote)
      return;
    now_.text += quote;
  }
}

void ConditionWords::read_number() {
  const char* const first = text_.data() + at_;
  const char* const last = text_.data() + text_.size();
  const auto [end, error] = std::from_chars(first, last, now_.number);
  if (error != std::errc{} || !std::isfinite(now_.number) || (end != last && continues_name(*end)))
    fail(at_, "this is no number; names that begin with a digit stand in double quotes");
  now_.kind = WordKind::number;
  now_.text = std::string(first, end);
  at_ += now_.text.size();
}

void ConditionWords::read_sign() {
  const std::string_view rest = text_.substr(at_);
  const auto* const found =
      std::ranges::find_if(kSigns, [&](std::string_view sign) { return rest.starts_with(sign); });
  if (found == kSigns.end())
    fail(at_, fmt::format("{} means nothing here; names with such characters stand in double "
                          "quotes, texts in single ones",
                          plain_text(rest.substr(0, 1), 1)));
  now_.kind = WordKind::sign;
  now_.text = *found;
  at_ += found->size();
}

}  // namespace meshhier::exporting
