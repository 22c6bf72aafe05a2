// A text in blocks of whole lines, which can be read one by one and in any order.
#pragma once

#include "mesh_io/input_stream.h"

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// Returns how many bytes at the start of a text make a block of whole lines, where more text
/// follows; 0 if none do.
using LineCut = std::size_t (*)(std::string_view text);

/// Cuts behind the last line end. Lines end with LF, CRLF or CR; a backslash before a line's end
/// joins it with the next one.
std::size_t whole_lines(std::string_view text);

/// Cuts a stream into blocks. A byte order mark of UTF-8 at the start is left out. For one thread.
class LineBlocks {
 public:
  /// The largest size of a block.
  static constexpr std::size_t kBytes = std::size_t{1} << 18;

  explicit LineBlocks(InputStream& stream, LineCut cut = whole_lines);
  ~LineBlocks();

  /// Reads the next lines into `block`, as many as fit and the cut allows; the file's last one may
  /// have no end. Returns false at the end of the file, or if the next lines do not fit: then
  /// rest() has them and all behind them.
  bool next(std::vector<char>& block);
  /// Returns, as a stream, the bytes that next() has not handed out; it hands out none any more.
  /// Valid as long as this object.
  InputStream& rest();

 private:
  class Rest;

  InputStream& stream_;
  LineCut cut_;
  std::vector<char> left_;  ///< the start of a line, from the block before
  bool has_begun_ = false;
  bool has_ended_ = false;
  std::unique_ptr<Rest> rest_;
};

}  // namespace meshhier::mesh_io
