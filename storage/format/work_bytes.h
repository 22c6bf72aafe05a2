// Arrays one after another as bytes, for scratch space only: in this machine's byte order.
#pragma once

#include "base/error.h"

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace meshhier::storage {

class Packer {
 public:
  explicit Packer(std::size_t size) { bytes_.reserve(size); }
  template <class T>
  void put(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto raw_bytes = std::as_bytes(values);
    bytes_.insert(bytes_.end(), raw_bytes.begin(), raw_bytes.end());
  }
  /// Appends room for `count` values, one after another.
  template <class T>
  std::byte* make_room(std::size_t count) {
    const std::size_t size = bytes_.size();
    bytes_.resize(size + count * sizeof(T));
    return bytes_.data() + size;
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  std::vector<T> get(std::size_t count) {
    const std::byte* const from = skip<T>(count);
    std::vector<T> values(count);
    if (count > 0)
      std::memcpy(values.data(), from, count * sizeof(T));
    return values;
  }
  /// Returns where the next `count` values lie, whatever their alignment, and passes over them.
  template <class T>
  const std::byte* skip(std::size_t count) {
    if (count > bytes_.size() / sizeof(T))
      throw Error(ErrorCode::internal, "what was put into scratch space is cut short");
    const std::byte* const from = bytes_.data();
    bytes_ = bytes_.subspan(count * sizeof(T));
    return from;
  }
  void finish() const {
    if (!bytes_.empty())
      throw Error(ErrorCode::internal, "what was put into scratch space has bytes too many");
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace meshhier::storage
