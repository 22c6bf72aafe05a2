#include "mesh_io/text_cursor.h"

namespace meshhier::mesh_io {

bool TextCursor::to_row() {
  while (!to_word()) {
    if (window_.available() == 0)
      return false;
    const std::byte c = *window_.begin();
    window_.advance(1);
    // CR LF is one line end: the LF counts.
    const bool joined = c == std::byte{'\r'} && look_ahead() && *window_.begin() == std::byte{'\n'};
    if (!joined)
      ++line_;
  }
  return true;
}

void TextCursor::skip_line() {
  while (look_ahead()) {
    const std::byte* at = window_.begin();
    while (at != window_.end() && kind_of(*at) != Kind::line_end)
      ++at;
    const bool found = at != window_.end();
    window_.advance(static_cast<std::size_t>(at - window_.begin()));
    if (found)
      return;
  }
}

}  // namespace meshhier::mesh_io
