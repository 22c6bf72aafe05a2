#include "app/shell_word.h"

#include <algorithm>

#include <fmt/format.h>

namespace meshhier::app {
namespace {

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_-./+=:,@%").find(c) != std::string_view::npos;
}

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

std::string with_escapes(std::string_view word) {
  std::string text = "$'";
  for (const char c : word) {
    if (is_control(c))
      text += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
    else if (c == '\'' || c == '\\')
      text += {'\\', c};
    else
      text += c;
  }
  return text + '\'';
}

std::string quoted(std::string_view word) {
  std::string text = "'";
  for (const char c : word)
    text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + '\'';
}

}  // namespace

std::string shell_word(std::string_view word) {
  if (std::ranges::any_of(word, is_control))
    return with_escapes(word);
  if (!word.empty() && std::ranges::all_of(word, is_plain))
    return std::string(word);
  return quoted(word);
}

}  // namespace meshhier::app
