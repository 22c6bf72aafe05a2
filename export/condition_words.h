// The words of a condition: names, texts, numbers, signs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace meshhier::exporting {

enum class WordKind : std::uint8_t { end, name, quoted_name, text, number, sign };

struct ConditionWord {
  WordKind kind = WordKind::end;
  std::string text{};  ///< without its quotes
  double number = 0;
  std::size_t place = 0;  ///< of its first byte

  /// Returns whether it is a sign, or a name without quotes, in any letters.
  bool is(std::string_view word) const;
};

/// Reads a condition word by word. `text` must outlive it. Everything throws Error(usage), which
/// tells the place in characters, counted from 1.
class ConditionWords {
 public:
  explicit ConditionWords(std::string_view text);

  const ConditionWord& now() const { return now_; }
  /// Returns the word that was there, and goes on.
  ConditionWord take();
  /// Goes on if the word is there.
  bool take_if(std::string_view word);
  void require(std::string_view word);

  [[noreturn]] void fail(std::size_t place, const std::string& what) const;
  /// Says what should stand where the word is.
  [[noreturn]] void fail_expected(const std::string& what) const;

 private:
  void read();
  void read_quoted(char quote);
  void read_number();
  void read_sign();

  std::string_view text_;
  std::size_t at_ = 0;
  ConditionWord now_;
};

}  // namespace meshhier::exporting
