#include "app/token_file.h"

#include "base/error.h"
#include "base/text_mark.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <fmt/format.h>

namespace meshhier::app {
namespace {

/// A token of 16 random letters and digits has 95 bits.
constexpr std::size_t kFewestCharacters = 16;
constexpr std::uint64_t kMostBytes = 1024;

bool is_visible(char c) {
  return c > ' ' && c < '\x7f';
}

}  // namespace

std::string read_token(storage::FileSystem& files, std::string_view option,
                       const std::filesystem::path& path) {
  const std::unique_ptr<storage::File> file = files.open(path);
  std::string token(std::min(file->size(), kMostBytes + 1), '\0');
  file->read_exact(0, std::as_writable_bytes(std::span(token)));
  token = without_mark(token);
  token.erase(token.find_last_not_of(" \t\r\n") + 1);
  if (token.size() >= kFewestCharacters && token.size() <= kMostBytes &&
      std::all_of(token.begin(), token.end(), is_visible))
    return token;
  throw Error(ErrorCode::usage, fmt::format("{} {}: expected one word of {} to {} visible ASCII "
                                            "characters; make one with: openssl rand -hex 32",
                                            option, path.string(), kFewestCharacters, kMostBytes));
}

}  // namespace meshhier::app
