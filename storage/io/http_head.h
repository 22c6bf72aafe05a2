// The header of an answer over HTTP (RFC 9110): which file came, and which part of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::storage {

/// A header whose lines are added as they come. Redirects make several: the last one counts.
struct HttpHead {
  std::optional<std::uint64_t> first;   ///< offset in Content-Range
  std::optional<std::uint64_t> total;   ///< bytes of the file, likewise
  std::optional<std::uint64_t> length;  ///< bytes of the answer
  std::string impossible;               ///< a length that no file has
  std::string encoding;                 ///< Content-Encoding; empty: none
  std::size_t bytes = 0;                ///< size of the header so far
  bool is_complete = false;             ///< all of it has come

  /// Takes a line, with its end. Unknown headers and lines that are none only count as bytes.
  void add(std::string_view line);
  /// Returns the file's ETag, else Last-Modified; empty: not known.
  const std::string& version() const { return etag_.empty() ? modified_ : etag_; }

 private:
  std::optional<std::uint64_t> length_of(std::string_view text);
  void add_range(std::string_view value);

  std::string etag_, modified_;
};

}  // namespace meshhier::storage
