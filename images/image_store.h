// Pictures of any size and number on disk, to be read by the rectangle.
//
// Each picture lies in blocks of 64 x 64 texels, with a pyramid above it: each level has half of
// the width and height of the one below (rounded up), its texels are means of up to four in linear
// light, weighted by alpha. Pictures are decoded once, row by row; blocks that are read lie in a
// cache of fixed size. Results never depend on the cache.
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
  std::int64_t x = 0, y = 0;  ///< the upper left texel; any number, as wraps count
  std::uint32_t width = 0, height = 0;
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
};

/// Thread-safe but for add() and restore().
class ImageStore {
 public:
  static constexpr std::uint32_t kBlockSide = 64;

  /// `cache_bytes`: the most memory of decoded blocks. `scratch` must outlive it.
  ImageStore(storage::ScratchFile& scratch, std::uint64_t cache_bytes);
  ~ImageStore();

  /// Called after each row of a picture's blocks, with the number of its texels; may throw.
  using Step = std::function<void(std::uint64_t texels)>;

  /// Decodes a picture into the scratch file, to be added by add(). Throws as ImageReader, and
  /// Error(io). O(texels) time, O(width) memory besides the reader's.
  StoredImage write(ImageReader& reader, const Step& step) const;
  /// Gives the next number to a picture that was written.
  void add(StoredImage written);
  /// Writes and adds a picture.
  void add(ImageReader& reader, const Step& step) { add(write(reader, step)); }

  /// Takes pictures that an earlier process added, all or none; returns false if the scratch file
  /// does not hold them any more, for which it reads them all, but for strips of mounted files:
  /// these are checked when they are used. Requires an empty store, and a scratch file to which
  /// nothing was appended yet.
  bool restore(std::span<const StoredImage> images);
  /// Returns the facts that restore() takes, once the scratch file is synced.
  const StoredImage& stored(std::uint32_t image) const;

  std::size_t size() const;
  const ImageInfo& info(std::uint32_t image) const;
  /// Returns the number of levels of its pyramid, the last of 1 x 1 texels.
  std::uint32_t levels(std::uint32_t image) const;

  /// Writes the rectangle into `into` at (at_x, at_y), where it must fit; `into` has 3 channels
  /// (alpha is dropped) or 4 (alpha is 255 if the picture has none). Throws Error(io), and
  /// Error(corrupt) if a mounted scratch file has changed.
  void read(const TexelRect& rect, Image& into, std::uint32_t at_x, std::uint32_t at_y) const;

  /// Returns the bytes of scratch space that a picture of this size takes, with its pyramid.
  static std::uint64_t stored_bytes(std::uint32_t width, std::uint32_t height,
                                    std::uint32_t channels);
  /// Returns the bytes of memory that write() holds besides the reader's.
  static std::uint64_t adding_bytes(std::uint32_t width, std::uint32_t height,
                                    std::uint32_t channels);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshhier::images
