// Parses Range headers, which ask for a part of a file (RFC 9110, section 14).
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace meshhier::server {

struct ByteRange {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

struct RangeAnswer {
  enum class Kind {
    whole,   ///< the header is to be ignored, as is one that asks for several ranges
    part,    ///< 206
    outside  ///< 416
  };
  Kind kind = Kind::whole;
  ByteRange range;  ///< only of a part: at least one byte, within the file
};

/// Returns the part of a file of `file_bytes` that a header asks for. `header`: the value, which
/// nobody vouches for. Never throws.
RangeAnswer find_range(std::string_view header, std::uint64_t file_bytes);

}  // namespace meshhier::server
