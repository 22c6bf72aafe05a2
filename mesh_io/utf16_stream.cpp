#include "mesh_io/utf16_stream.h"

#include "mesh_io/input_error.h"

#include <algorithm>
#include <array>

namespace meshhier::mesh_io {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 16;
constexpr char32_t kReplacement = 0xFFFD;

bool is_high_half(char32_t unit) {
  return unit >= 0xD800 && unit < 0xDC00;
}
bool is_low_half(char32_t unit) {
  return unit >= 0xDC00 && unit < 0xE000;
}

}  // namespace

Utf16Stream::Utf16Stream(InputStream& stream, const std::filesystem::path& path)
    : stream_(stream), path_(path), ready_(2) {
  ready_.resize(stream_.read(ready_));
  const auto begins = [&](int first, int second) {
    return ready_.size() == 2 && ready_[0] == std::byte(first) && ready_[1] == std::byte(second);
  };
  is_big_endian_ = begins(0xFE, 0xFF);
  is_utf16_ = is_big_endian_ || begins(0xFF, 0xFE);
  if (is_utf16_)
    ready_.clear();
}

std::size_t Utf16Stream::read(std::span<std::byte> to) {
  std::size_t done = 0;
  while (done < to.size()) {
    if (taken_ == ready_.size()) {
      if (!is_utf16_)
        return done + stream_.read(to.subspan(done));
      fill();
      if (ready_.empty())
        return done;
    }
    const std::size_t count = std::min(to.size() - done, ready_.size() - taken_);
    std::copy_n(ready_.begin() + static_cast<std::ptrdiff_t>(taken_), count,
                to.begin() + static_cast<std::ptrdiff_t>(done));
    taken_ += count;
    done += count;
  }
  return done;
}

/// Fills ready_ with the next characters; it stays empty at the end.
void Utf16Stream::fill() {
  ready_.clear();
  taken_ = 0;
  std::vector<std::byte> block(kBlockBytes);
  while (ready_.empty()) {
    block.resize(kBlockBytes);
    block.resize(stream_.read(block));
    if (block.size() % 2 != 0)
      fail_file(path_, "is a text in UTF-16, but ends within a character");
    if (block.empty()) {
      if (high_)
        append(kReplacement);
      high_.reset();
      return;
    }
    for (std::size_t i = 0; i < block.size(); i += 2) {
      const auto high = std::to_integer<char32_t>(block[i + (is_big_endian_ ? 0 : 1)]);
      const auto unit = high << 8 | std::to_integer<char32_t>(block[i + (is_big_endian_ ? 1 : 0)]);
      if (high_ && is_low_half(unit)) {
        append(0x10000 + ((*high_ - 0xD800) << 10) + (unit - 0xDC00));
        high_.reset();
        continue;
      }
      if (high_)
        append(kReplacement);
      high_.reset();
      if (is_high_half(unit))
        high_ = unit;
      else
        append(is_low_half(unit) ? kReplacement : unit);
    }
  }
}

void Utf16Stream::append(char32_t c) {
  const auto put = [&](char32_t byte) { ready_.push_back(static_cast<std::byte>(byte)); };
  const auto put_rest = [&](int bytes) {
    for (int i = bytes; i-- > 0;)
      put(0x80 | (c >> (6 * i) & 0x3F));
  };
  if (c < 0x80)
    return put(c);
  const int more = c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
  constexpr std::array<char32_t, 4> kFirst{0, 0xC0, 0xE0, 0xF0};
  put(kFirst[static_cast<std::size_t>(more)] | c >> (6 * more));
  put_rest(more);
}

}  // namespace meshhier::mesh_io
