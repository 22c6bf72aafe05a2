// A bit for each texel of a picture, 64 of a row in a word.
#pragma once

#include "texture/texel_segment.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::texture {

class TexelBits {
 public:
  using Word = std::uint64_t;
  static constexpr std::uint32_t kWordBits = 64;

  /// No bit is set.
  TexelBits(std::uint32_t width, std::uint32_t height)
      : width_(width),
        height_(height),
        row_words_((width + kWordBits - 1) / kWordBits),
        words_(std::size_t{row_words_} * height) {}

  bool operator()(std::uint32_t x, std::uint32_t y) const {
    return (word(x, y) >> x % kWordBits & 1) != 0;
  }
  void set(std::uint32_t x, std::uint32_t y) { words_[index(x, y)] |= Word{1} << x % kWordBits; }
  /// Sets [begin, end) of a row; there must be some. O(words).
  void set_run(std::uint32_t y, std::uint32_t begin, std::uint32_t end) {
    all_masks(begin, end, [&](std::uint32_t number, Word mask) {
      words_[row(y) + number] |= mask;
      return true;
    });
  }
  /// Whether all of a range are set. O(words).
  bool is_full(const TexelRange& range) const {
    for (std::uint32_t y = range.top; y < range.bottom && range.left < range.right; ++y) {
      if (!all_masks(range.left, range.right, [&](std::uint32_t number, Word mask) {
            return (words_[row(y) + number] & mask) == mask;
          }))
        return false;
    }
    return true;
  }
  /// Returns the bits of a square, row by row. Requires a side of up to 8, a power of two that
  /// divides x.
  Word square(std::uint32_t x, std::uint32_t y, std::uint32_t side) const {
    Word bits = 0;
    for (std::uint32_t j = 0; j < side; ++j)
      bits |= (word(x, y + j) >> x % kWordBits & ~(~Word{0} << side)) << j * side;
    return bits;
  }
  /// Calls visit(x) for each one of a row that is set, from the left.
  template <class Visit>
  void for_each_in(std::uint32_t y, const Visit& visit) const {
    for (std::uint32_t i = 0; i < row_words_; ++i) {
      for (Word left = words_[row(y) + i]; left != 0; left &= left - 1)
        visit(i * kWordBits + static_cast<std::uint32_t>(std::countr_zero(left)));
    }
  }
  /// Returns the bits of a picture of half the size: set where one of four is. Requires even sides.
  TexelBits any_of_four() const {
    return halved([](Word a, Word b) {
      const Word both = a | b;
      return both | both >> 1;
    });
  }
  /// Returns the same, set where all four are.
  TexelBits all_of_four() const {
    return halved([](Word a, Word b) {
      const Word both = a & b;
      return both & both >> 1;
    });
  }

 private:
  std::size_t row(std::uint32_t y) const { return std::size_t{y} * row_words_; }
  std::size_t index(std::uint32_t x, std::uint32_t y) const { return row(y) + x / kWordBits; }
  Word word(std::uint32_t x, std::uint32_t y) const { return words_[index(x, y)]; }

  /// Calls visit(number of the word in its row, bits of [begin, end) in it) while it returns true;
  /// returns whether it always did. Requires begin < end.
  template <class Visit>
  static bool all_masks(std::uint32_t begin, std::uint32_t end, const Visit& visit) {
    const std::uint32_t last = (end - 1) / kWordBits;
    Word mask = ~Word{0} << begin % kWordBits;
    for (std::uint32_t i = begin / kWordBits; i < last; ++i, mask = ~Word{0}) {
      if (!visit(i, mask))
        return false;
    }
    return visit(last, mask & ~Word{0} >> (kWordBits - 1 - (end - 1) % kWordBits));
  }
  /// `join` makes of two words, one above the other, one whose bits at even places count.
  template <class Join>
  TexelBits halved(const Join& join) const {
    TexelBits half(width_ / 2, height_ / 2);
    for (std::uint32_t y = 0; y < half.height_; ++y) {
      for (std::uint32_t i = 0; i < row_words_; ++i) {
        const Word pairs = even_bits(join(words_[row(2 * y) + i], words_[row(2 * y + 1) + i]));
        half.words_[half.row(y) + i / 2] |= pairs << i % 2 * (kWordBits / 2);
      }
    }
    return half;
  }
  /// Moves the bits at even places to the lower half.
  static Word even_bits(Word bits) {
    bits &= 0x5555555555555555;
    bits = (bits | bits >> 1) & 0x3333333333333333;
    bits = (bits | bits >> 2) & 0x0f0f0f0f0f0f0f0f;
    bits = (bits | bits >> 4) & 0x00ff00ff00ff00ff;
    bits = (bits | bits >> 8) & 0x0000ffff0000ffff;
    return (bits | bits >> 16) & 0x00000000ffffffff;
  }

  std::uint32_t width_, height_, row_words_;
  std::vector<Word> words_;
};

}  // namespace meshhier::texture
