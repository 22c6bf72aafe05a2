#include "mesh_io/input_error.h"

#include "base/error.h"
#include "base/plain_text.h"

#include <cstddef>

#include <fmt/format.h>

namespace meshhier::mesh_io {

std::string file_message(const std::filesystem::path& path, const std::string& message) {
  constexpr std::size_t kLongestPath = 4096;
  return fmt::format("{}: {}", plain_text(path.string(), kLongestPath), message);
}

void fail_file(const std::filesystem::path& path, const std::string& message) {
  throw Error(ErrorCode::input, file_message(path, message));
}

void fail_at_byte(const std::filesystem::path& path, std::uint64_t offset,
                  const std::string& message) {
  fail_file(path, fmt::format("byte {}: {}", offset, message));
}

std::string line_message(const std::filesystem::path& path, std::uint64_t line,
                         const std::string& message) {
  return file_message(path, fmt::format("line {}: {}", line, message));
}

void fail_at_line(const std::filesystem::path& path, std::uint64_t line,
                  const std::string& message) {
  throw Error(ErrorCode::input, line_message(path, line, message));
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kShownBytes = 40;  // a long number still shows whole
  std::string shown = "'";
  for (const char c : text.substr(0, kShownBytes)) {
    shown += c >= ' ' && c <= '~' ? c : '?';
  }
  return shown + (text.size() > kShownBytes ? "...'" : "'");
}

std::string number_in_quotes(std::string_view word) {
  const bool has_comma = word.find(',') != std::string_view::npos;
  return in_quotes(word) + (has_comma ? " (numbers have a decimal point, not a comma; write them "
                                        "again with points)"
                                      : "");
}

}  // namespace meshhier::mesh_io
