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

}  // namespace meshhier::mesh_io
