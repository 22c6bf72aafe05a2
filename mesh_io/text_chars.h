// What separates words and lines.
#pragma once

namespace meshhier::mesh_io {

constexpr bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}
constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

}  // namespace meshhier::mesh_io
