#include "mesh_io/json_characters.h"

#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace meshhier::mesh_io {
namespace {

/// No path is longer; what is cut from a text is base64.
constexpr std::size_t kMostTextBytes = 8192;
/// No number is longer; a list of them without end would be one token.
constexpr std::size_t kMostNumberBytes = 1024;
constexpr std::size_t kGlbJsonOffset = 20;
constexpr std::size_t kJsonBlockBytes = std::size_t{1} << 16;

bool is_number_part(int c) {
  return c > ' ' && c != ',' && c != ':' && c != '[' && c != ']';
}

/// Returns whether a byte of UTF-8 follows the first byte of a character.
bool is_continuation(int c) {
  return (c & 0xC0) == 0x80;
}

}  // namespace

JsonCharacters::JsonCharacters(InputStream& stream) : stream_(stream) {
  std::array<std::byte, kGlbJsonOffset> head{};
  const std::size_t got = stream_.read(head);
  if (got == head.size() &&
      std::string_view(reinterpret_cast<const char*>(head.data()), 4) == "glTF") {
    left_ = storage::load_little<std::uint32_t>(head.data() + 12);
  } else {
    block_.assign(head.begin(), head.begin() + static_cast<std::ptrdiff_t>(got));
  }
}

int JsonCharacters::next() {
  for (;;) {
    const int c = next_stored();
    if (!in_text_) {
      in_text_ = c == '"';
      token_ = is_number_part(c) ? token_ + 1 : 0;
      return token_ > kMostNumberBytes ? -1 : c;
    }
    if (c < 0 || (c == '"' && !escaped_)) {
      in_text_ = false;
      token_ = 0;
      return c;
    }
    // An escape and a character are kept or cut as a whole; the longest have six and four bytes.
    const std::size_t more = c == '\\' ? 6 : c >= 0xC0 ? 4 : 0;
    const bool is_kept = escaped_ || is_continuation(c) ? kept_ : token_ + more < kMostTextBytes;
    kept_ = is_kept;
    escaped_ = !escaped_ && c == '\\';
    ++token_;
    if (is_kept)
      return c;
  }
}

int JsonCharacters::next_stored() {
  if (at_ == block_.size() && !load())
    return -1;
  return std::to_integer<int>(block_[at_++]);
}

bool JsonCharacters::load() {
  block_.resize(std::min<std::uint64_t>(kJsonBlockBytes, left_));
  block_.resize(stream_.read(block_));
  left_ -= block_.size();
  at_ = 0;
  return !block_.empty();
}

}  // namespace meshhier::mesh_io
