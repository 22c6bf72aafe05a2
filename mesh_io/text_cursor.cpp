#include "mesh_io/text_cursor.h"

namespace meshhier::mesh_io {
namespace {

char char_at(const std::byte* at) {
  return static_cast<char>(*at);
}

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}

}  // namespace

bool TextCursor::to_row() {
  while (!to_word()) {
    if (window_.available() == 0)
      return false;
    const char c = char_at(window_.begin());
    window_.advance(1);
    // CR LF is one line end: the LF counts.
    const bool joined = c == '\r' && look_ahead() && char_at(window_.begin()) == '\n';
    if (!joined)
      ++line_;
  }
  return true;
}

bool TextCursor::to_word() {
  while (look_ahead()) {
    const std::byte* at = window_.begin();
    while (at != window_.end() && is_blank(char_at(at)))
      ++at;
    const bool found = at != window_.end();
    const bool ended = found && is_line_end(char_at(at));
    window_.advance(static_cast<std::size_t>(at - window_.begin()));
    if (found)
      return !ended;
  }
  return false;
}

std::string_view TextCursor::take_word() {
  look_ahead();
  const std::byte* const first = window_.begin();
  const std::byte* at = first;
  while (at != window_.end() && !is_blank(char_at(at)) && !is_line_end(char_at(at)))
    ++at;
  const auto size = static_cast<std::size_t>(at - first);
  if (size > kMaxWordBytes)
    return {};
  window_.advance(size);
  return {reinterpret_cast<const char*>(first), size};
}

}  // namespace meshhier::mesh_io
