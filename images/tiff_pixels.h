// The samples of the images in a TIFF, block by block: what heights and pictures are read from.
//
// Problem. A file may be one strip of gigabytes, or millions of tiles; its tags may say anything;
// and the library's handles are for one thread each.
// Idea. An image is a grid of blocks, each of which can be decoded alone; where rows lie in the
// file as they are, a block is some of them, however large the file's own blocks are. Each thread
// at work has a handle of its own.
// Invariant. No block is larger than kMostTiffBlock. All sizes are checked before memory is taken.
#pragma once

#include "images/tiff_file.h"
#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::images {

/// The most bytes of a decoded block.
inline constexpr std::uint64_t kMostTiffBlock = std::uint64_t{256} << 20;
/// The most memory that a file's tags take, and the most images of it that are looked at.
inline constexpr std::uint64_t kMostTiffHead = std::uint64_t{64} << 20;
inline constexpr std::size_t kMostTiffImages = 256;

/// An image among those of a file.
struct TiffDirectory {
  std::uint64_t offset = 0;  ///< in the file
  std::uint32_t width = 0, height = 0;
  bool is_reduced = false;  ///< smaller than another one, which it shows
  bool is_mask = false;     ///< tells which pixels of another one are seen

  /// Whether it has pixels of its own, in full resolution.
  bool is_full() const { return !is_reduced && !is_mask; }
};

/// Returns the images of a file in their order, at most so many. Throws as TiffFile.
std::vector<TiffDirectory> tiff_directories(TiffFile& tiff, std::size_t most = kMostTiffImages);
/// Returns the first image of full resolution, the one that is shown; null if there is none.
const TiffDirectory* full_image(std::span<const TiffDirectory> images);
/// Returns the mask of an image, which has its size; null if there is none.
const TiffDirectory* mask_of(std::span<const TiffDirectory> images, const TiffDirectory& image);

enum class TiffSamples : std::uint8_t { unsigned_integers, integers, reals };

/// The form of an image, by its tags.
struct TiffLayout {
  std::uint32_t width = 0, height = 0;
  std::uint32_t bands = 1;  ///< samples of a pixel
  std::uint32_t bits = 8;   ///< of a sample
  TiffSamples samples = TiffSamples::unsigned_integers;
  std::uint32_t photometric = 0;  ///< the library's constant
  std::uint32_t compression = 0;  ///< likewise
  std::uint32_t alpha_band = 0;   ///< 0: there is none
  bool is_separate = false;       ///< each band has blocks of its own
  std::uint32_t block_width = 0, block_height = 0;

  std::uint32_t columns() const { return (width - 1) / block_width + 1; }
  std::uint32_t rows() const { return (height - 1) / block_height + 1; }
  /// Returns whether it shows colours, or greys as photographs are packed.
  bool is_picture() const;
  /// Returns the bytes of a row of a block, and of a block.
  std::uint64_t block_stride() const {
    return (std::uint64_t{block_width} * (is_separate ? 1 : bands) * bits + 7) / 8;
  }
  std::uint64_t block_bytes() const { return block_stride() * block_height; }
};

/// An image of a file. Thread-safe.
class TiffPixels {
 public:
  /// `offset`: TiffDirectory::offset. `file` must outlive this. Throws Error(input) that names the
  /// file if tags are missing or contradict each other, or if its blocks are too many or too large.
  TiffPixels(const storage::File& file, std::uint64_t offset);
  ~TiffPixels();

  const TiffLayout& layout() const { return layout_; }

  /// A block: its place among the columns and rows of blocks, and its band if these are separate.
  struct Block {
    std::uint32_t column = 0, row = 0;
    std::uint32_t band = 0;
  };
  /// Reads and decodes a block into block_bytes(): samples in this machine's order, rows of
  /// block_stride(). What lies beyond the image means nothing. Throws as TiffFile::read_block().
  void read_block(const Block& block, std::span<std::byte> into) const;
  /// Says which sample stands where the file leaves out a block; without it that is 0. To be called
  /// before blocks are read.
  void set_absent(std::vector<std::byte> sample) { absent_ = std::move(sample); }

 private:
  class Lease;

  std::unique_ptr<TiffFile> open() const;
  void read_layout(TiffFile& tiff);
  void read_blocks(TiffFile& tiff);
  bool has_plain_rows(TiffFile& tiff) const;
  void fill_absent(std::span<std::byte> into) const;
  void read_plain_rows(TiffFile& tiff, const Block& block, std::span<std::byte> into) const;
  void read_plain(TiffFile& tiff, std::uint32_t strip, std::uint64_t skipped,
                  std::span<std::byte> into) const;
  std::uint32_t index_of(const Block& block) const;

  const storage::File& file_;
  std::uint64_t offset_;
  TiffLayout layout_;
  /// Rows of a strip of the file whose rows lie there as they are; 0: blocks are the file's own.
  std::uint32_t plain_strip_ = 0;
  bool is_swapped_ = false;  ///< the file has the other order of bytes
  std::vector<std::byte> absent_;

  mutable std::mutex mutex_;  ///< guards idle_
  mutable std::vector<std::unique_ptr<TiffFile>> idle_;
};

}  // namespace meshhier::images
