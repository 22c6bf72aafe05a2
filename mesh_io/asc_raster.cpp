// Heights as a text grid of ESRI: a head of words and numbers, then rows of numbers from north to
// south.
//
//   ncols 4  nrows 3  xllcorner 500000  yllcorner 5300000  cellsize 10  NODATA_value -9999
//   1 2 3 4 ...
//
// Problem. A number's place in the file is known once all before it have been read.
// Idea. Blocks of rows end where the next one begins: the ends are found as the text is read for
// the first time, and kept.
#include "mesh_io/asc_head.h"
#include "mesh_io/beside_raster.h"
#include "mesh_io/blocked_raster.h"
#include "mesh_io/input_error.h"
#include "mesh_io/number_text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::string_view kAscBlanks = " \t\r\n";

/// Takes words from a file, from a byte on.
class AscWords {
 public:
  AscWords(const storage::File& file, std::uint64_t offset) : file_(file), offset_(offset) {}

  /// Returns the next word, valid until the next call; empty at the end.
  std::string_view next() {
    for (;;) {
      const std::size_t begin = text_.find_first_not_of(kAscBlanks, at_);
      const std::size_t end =
          begin == std::string::npos ? begin : text_.find_first_of(kAscBlanks, begin);
      if (end != std::string::npos || is_at_end_) {
        if (begin == std::string::npos)
          return {};
        at_ = std::min(end, text_.size());
        return std::string_view(text_).substr(begin, at_ - begin);
      }
      refill();
    }
  }
  /// Returns the byte behind the last word.
  std::uint64_t offset() const { return offset_ + at_; }

 private:
  void refill() {
    constexpr std::size_t kPart = std::size_t{1} << 16;
    constexpr std::size_t kLongestWord = 4096;
    const std::size_t begin = std::min(text_.find_first_not_of(kAscBlanks, at_), text_.size());
    text_.erase(0, begin);
    offset_ += begin;
    at_ = 0;
    const std::size_t left = text_.size();
    if (left > kLongestWord)
      fail_at_byte(file_.path(), offset_, "expected a number, found " + in_quotes(text_));
    text_.resize(left + kPart);
    const std::size_t read = file_.read_at(
        offset_ + left, std::as_writable_bytes(std::span(text_)).subspan(left, kPart));
    text_.resize(left + read);
    is_at_end_ = read == 0;
  }

  const storage::File& file_;
  std::uint64_t offset_;  ///< of text_
  std::string text_;
  std::size_t at_ = 0;
  bool is_at_end_ = false;
};

class AscRaster final : public BlockedRaster {
 public:
  AscRaster(std::unique_ptr<storage::File> file, storage::FileSystem& files)
      : file_(std::move(file)) {
    AscHead asc = read_asc_head(*file_);
    absent_ = asc.absent;
    RasterHead head{.path = file_->path(), .columns = asc.columns, .rows = asc.rows};
    head.map = asc.map;
    head.may_have_voids = true;
    read_crs(files, head);
    rows_ = rows_of_block(asc.rows, std::uint64_t{sizeof(double)} * asc.columns);
    begins_ = {asc.bytes};
    set(std::move(head), {asc.columns, rows_, sizeof(double)});
  }

 private:
  static void read_crs(storage::FileSystem& files, RasterHead& head) {
    auto crs = read_crs_file(files, head.path);
    if (!crs)
      return;
    head.keys = std::move(crs->keys);
    if (head.keys.kind == geodesy::MapKind::unknown)
      head.warnings.push_back(file_message(crs->path, "is no WKT of a map: it is not used"));
  }

  void decode(const BlockPlace& place, std::span<std::byte> into) const override {
    AscWords words(*file_, begin_of(place.row));
    const std::uint32_t rows = std::min(rows_, head_.rows - place.row * rows_);
    const std::size_t count = std::size_t{rows} * head_.columns;
    for (std::size_t i = 0; i < count; ++i) {
      const double height = number_of(words.next(), place.row, i, words);
      std::memcpy(into.data() + i * sizeof height, &height, sizeof height);
    }
    if (place.row * rows_ + rows == head_.rows)
      require_end(words);
    note_begin(place.row + 1, words.offset());
  }

  /// Numbers that are left over mean rows longer than the head says: all would lie askew.
  void require_end(AscWords& words) const {
    const std::string_view word = words.next();
    if (!word.empty()) {
      fail_at_byte(head_.path, words.offset() - word.size(),
                   fmt::format("expected the end behind {} rows of {}, found {}", head_.rows,
                               head_.columns, number_in_quotes(word)));
    }
  }

  double number_of(std::string_view word, std::uint32_t block, std::size_t i,
                   const AscWords& words) const {
    const auto number = parse_real<double>(word);
    if (number)
      return absent_ && *number == *absent_ ? std::numeric_limits<double>::quiet_NaN() : *number;
    if (!word.empty())
      fail_at_byte(head_.path, words.offset() - word.size(),
                   "expected a height, found " + number_in_quotes(word));
    fail_file(head_.path, fmt::format("ends in row {} of {} (truncated?)",
                                      block * rows_ + i / head_.columns, head_.rows));
  }

  std::uint64_t begin_of(std::uint32_t block) const {
    const std::lock_guard lock(mutex_);
    while (begins_.size() <= block) {
      AscWords words(*file_, begins_.back());
      for (std::uint64_t i = 0; i < std::uint64_t{rows_} * head_.columns; ++i) {
        if (words.next().empty())
          break;  // whoever decodes the block will tell
      }
      begins_.push_back(words.offset());
    }
    return begins_[block];
  }

  void note_begin(std::uint32_t block, std::uint64_t offset) const {
    const std::lock_guard lock(mutex_);
    if (begins_.size() == block)
      begins_.push_back(offset);
  }

  void convert(const std::byte* from, std::span<double> heights) const override {
    std::memcpy(heights.data(), from, heights.size_bytes());
  }

  std::unique_ptr<storage::File> file_;
  std::optional<double> absent_;
  std::uint32_t rows_ = 0;
  mutable std::mutex mutex_;                   ///< guards begins_
  mutable std::vector<std::uint64_t> begins_;  ///< where blocks begin, as far as known
};

}  // namespace

std::unique_ptr<HeightRaster> open_asc(storage::FileSystem& files,
                                       const std::filesystem::path& path) {
  return std::make_unique<AscRaster>(files.open(path), files);
}

}  // namespace meshhier::mesh_io
