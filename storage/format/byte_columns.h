// Numbers and texts in columns: what is alike lies side by side, so that gzip finds it.
//
// A column of n numbers of w bytes is w planes of n bytes: the lowest byte of each, then the next
// one of each, and so on. A column of n texts is a column of their lengths, u32, then all texts.
#pragma once

#include "base/error.h"
#include "storage/io/little_endian.h"

#include <cstddef>
#include <cstdint>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// Writes one column behind the other.
class ColumnWriter {
 public:
  /// Appends a column of `numbers`, a sized range of T.
  template <Scalar T, std::ranges::sized_range Numbers>
  void numbers(const Numbers& numbers) {
    const std::size_t count = std::ranges::size(numbers), start = bytes_.size();
    bytes_.resize(start + count * sizeof(T));
    std::size_t i = start;
    for (const T number : numbers) {
      std::byte bytes[sizeof(T)];
      store_little(number, bytes);
      for (std::size_t plane = 0; plane < sizeof(T); ++plane)
        bytes_[i + plane * count] = bytes[plane];
      ++i;
    }
  }

  template <Scalar T>
  void number(T number) {
    numbers<T>(std::span(&number, 1));
  }

  /// Each of `texts` has less than 4 GiB.
  void texts(std::span<const std::string_view> texts) {
    numbers<std::uint32_t>(texts | std::views::transform([](std::string_view text) {
                             return static_cast<std::uint32_t>(text.size());
                           }));
    for (const std::string_view text : texts) {
      const auto bytes = std::as_bytes(std::span(text));
      bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
  }

  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads columns that nobody vouches for. Throws Error(corrupt) that starts with `name` where the
/// bytes end too early or too late; nothing is allocated for what is not there.
class ColumnReader {
 public:
  ColumnReader(std::span<const std::byte> bytes, const std::string& name)
      : bytes_(bytes), name_(name) {}

  template <Scalar T>
  std::vector<T> numbers(std::size_t count) {
    const std::span<const std::byte> planes = take(count, sizeof(T));
    std::vector<T> numbers(count);
    for (std::size_t i = 0; i < count; ++i) {
      std::byte bytes[sizeof(T)];
      for (std::size_t plane = 0; plane < sizeof(T); ++plane)
        bytes[plane] = planes[i + plane * count];
      numbers[i] = load_little<T>(bytes);
    }
    return numbers;
  }

  template <Scalar T>
  T number() {
    return numbers<T>(1).front();
  }

  /// The texts lie in the bytes that are read.
  std::vector<std::string_view> texts(std::size_t count) {
    std::vector<std::string_view> texts;
    for (const std::uint32_t length : numbers<std::uint32_t>(count)) {
      const std::span<const std::byte> text = take(length, 1);
      texts.emplace_back(reinterpret_cast<const char*>(text.data()), text.size());
    }
    return texts;
  }

  void finish() const {
    if (!bytes_.empty())
      fail("goes on behind its last column");
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::corrupt, name_ + ": " + what);
  }

 private:
  std::span<const std::byte> take(std::size_t count, std::size_t bytes_each) {
    if (count > bytes_.size() / bytes_each)
      fail("ends within a column");
    const std::span<const std::byte> taken = bytes_.first(count * bytes_each);
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }

  std::span<const std::byte> bytes_;
  const std::string& name_;
};

}  // namespace meshhier::storage
