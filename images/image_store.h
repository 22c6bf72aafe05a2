// Pictures of any size and number on disk, to be read by the rectangle.
//
// Each picture lies in blocks of 64 x 64 texels, with a pyramid above it: each level has half of
// the width and height of the one below (rounded up), its texels are means of up to four in linear
// light, weighted by alpha. Blocks are decoded once, row by row; what is read lies in a cache of
// fixed size. What is read never depends on the cache.
#pragma once

#include "hierarchy/texture.h"
#include "images/image.h"
#include "images/image_codec.h"
#include "images/stored_image.h"
#include "storage/io/spool.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace meshhier::images {

/// Part of a level of a picture; coordinates beyond the picture follow its wraps.
struct TexelRect {
  std::uint32_t image = 0;
  std::uint32_t level = 0;    ///< 0: the picture itself
  std::int64_t x = 0, y = 0;  ///< of the upper left texel; any, wraps count
  std::uint32_t width = 0, height = 0;
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
};

/// Thread-safe but for add() and restore().
class ImageStore {
 public:
  static constexpr std::uint32_t kBlockSide = 64;

  /// `cache_bytes`: of decoded blocks, at most.
  ImageStore(storage::ScratchFile& scratch, std::uint64_t cache_bytes);
  ~ImageStore();

  /// Called after each row of blocks of a picture with the texels it had; may throw.
  using Step = std::function<void(std::uint64_t texels)>;

  /// Decodes a picture, to be added. Throws as ImageReader. O(texels) time, O(width) memory besides
  /// the reader's.
  StoredImage write(ImageReader& reader, const Step& step) const;
  /// Gives the next number to a picture that was written.
  void add(StoredImage written);
  /// Both.
  void add(ImageReader& reader, const Step& step) { add(write(reader, step)); }

  /// Takes pictures that an earlier process added, all or none: false if the scratch file does not
  /// hold what was stored; reads it all. On an empty store, before anything is appended there.
  bool restore(std::span<const StoredImage> images);
  /// For restore(), once the scratch file is synced.
  const StoredImage& stored(std::uint32_t image) const;

  std::size_t size() const;
  const ImageInfo& info(std::uint32_t image) const;
  /// Levels of its pyramid, the last of 1 x 1 texels.
  std::uint32_t levels(std::uint32_t image) const;

  /// Writes the rectangle into `into` at (at_x, at_y), which has room for it; `into` has 3 channels
  /// (alpha is dropped) or 4 (it is 255 if the picture has none).
  void read(const TexelRect& rect, Image& into, std::uint32_t at_x, std::uint32_t at_y) const;

  /// Bytes of scratch space that a picture of this size takes, pyramid and all.
  static std::uint64_t stored_bytes(std::uint32_t width, std::uint32_t height,
                                    std::uint32_t channels);
  /// Bytes of memory that write() holds besides the reader's.
  static std::uint64_t adding_bytes(std::uint32_t width, std::uint32_t height,
                                    std::uint32_t channels);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshhier::images
