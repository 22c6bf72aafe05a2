// The common parts of the fuzz targets' bodies: promises, refusals, and bytes as numbers.
#pragma once

#include "base/error.h"
#include "hierarchy/tree.h"
#include "storage/format/glb.h"

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace meshhier::tests::fuzz {

using Bytes = std::span<const std::byte>;

/// A promise that an input broke: the finding of a fuzz run. Whatever else escapes from a body is
/// a finding too.
class Violation : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws Violation unless `kept`.
void require(bool kept, std::string_view promise);

/// A message is one line that a terminal shows as it is, and no longer than a screen has room for.
void require_message(std::string_view message, std::string_view start);

std::string_view text_of(Bytes bytes);
Bytes bytes_of(std::string_view text);

/// Returns the message by which `read` refuses the input; empty if it does not. It may throw Error
/// with one of `codes` and a message that begins with `start`, and nothing else.
template <class Read>
std::string refusal(std::initializer_list<ErrorCode> codes, std::string_view start,
                    const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    require(std::find(codes.begin(), codes.end(), error.code()) != codes.end(),
            "an error of another kind: " + std::string(error.what()));
    require_message(error.what(), start);
    return error.what();
  }
  return {};
}

/// Takes little endian numbers off the front; zeros where the bytes have ended.
class Take {
 public:
  explicit Take(Bytes bytes) : bytes_(bytes) {}

  template <storage::Scalar T>
  T number() {
    std::byte padded[sizeof(T)]{};
    std::copy_n(bytes_.begin(), std::min(sizeof(T), bytes_.size()), padded);
    skip(sizeof(T));
    return storage::load_little<T>(padded);
  }
  /// One of 0 .. most.
  template <storage::Scalar T>
  T upto(T most) {
    const T value = number<T>();
    return most + T{1} == T{0} ? value : static_cast<T>(value % (most + T{1}));
  }
  /// The next bytes; fewer where they end.
  Bytes bytes(std::size_t count) {
    const Bytes taken = bytes_.first(std::min(count, bytes_.size()));
    skip(count);
    return taken;
  }
  Bytes rest() const { return bytes_; }

 private:
  void skip(std::size_t count) { bytes_ = bytes_.subspan(std::min(count, bytes_.size())); }

  Bytes bytes_;
};

/// A tree of u32 vertices - 1 and u32 partitions - 1, each modulo what there can be.
Tree take_tree(Take& take);

}  // namespace meshhier::tests::fuzz
