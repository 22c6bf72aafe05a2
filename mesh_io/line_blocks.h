// A text in blocks of whole lines, which can be read one by one and in any order.
#pragma once

#include "mesh_io/input_stream.h"

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// Of a text that more follows, the bytes of its first lines, as many as make a block; 0 if none
/// do.
using LineCut = std::size_t (*)(std::string_view text);

/// Up to the last line end at which it can be cut: lines end with LF, CRLF or CR, and a backslash
/// before a line's end joins it with the next one.
std::size_t whole_lines(std::string_view text);

/// A byte order mark of UTF-8 at the start is left out.
class LineBlocks {
 public:
  /// Of a block, at most.
  static constexpr std::size_t kBytes = std::size_t{1} << 18;

  explicit LineBlocks(InputStream& stream, LineCut cut = whole_lines);
  ~LineBlocks();

  /// The next lines, as many as fit and the cut allows; the file's last one may have no end. False
  /// at the end of the file, or if the next lines do not fit: then rest() has them and all behind
  /// them.
  bool next(std::vector<char>& block);
  /// What next() has not handed out, as a stream; valid as long as this object.
  InputStream& rest();

 private:
  class Rest;

  InputStream& stream_;
  LineCut cut_;
  std::vector<char> left_;  ///< of the block before: the start of a line
  bool has_begun_ = false;
  bool has_ended_ = false;
  std::unique_ptr<Rest> rest_;
};

}  // namespace meshhier::mesh_io
