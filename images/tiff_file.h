// TIFF files by libtiff, read through files of storage/io.
//
// Problem. The library prints its errors, opens files by itself, and allocates what a file's tags
// ask for.
// Idea. Its bytes come from storage::File; what it says about a failure becomes the text
// of an Error; one allocation is at most as large as the caller has it. What a file of a user
// says of a block's bytes is compared with the file before the block is read.
#pragma once

#include "base/error.h"
#include "storage/io/file.h"

#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tiffio.h>

namespace meshhier::images {

/// The tags that place a raster in a map, by the GeoTIFF standard and by GDAL.
enum class GeoTag : std::uint32_t {
  pixel_scale = 33550,     ///< 3 doubles
  tie_points = 33922,      ///< 6 doubles each: column, row, level, x, y, z
  transformation = 34264,  ///< 16 doubles: a matrix by rows
  key_directory = 34735,   ///< uint16: 4 a key, 4 before them
  double_params = 34736,   ///< doubles that keys name
  ascii_params = 34737,    ///< text that keys name
  gdal_metadata = 42112,   ///< XML
  gdal_nodata = 42113,     ///< a number, as text
};

/// An open TIFF. For one thread; any number of them may read a file side by side.
class TiffFile {
 public:
  /// Opens a file for reading, at its first directory. No allocation of the library is larger than
  /// `most_bytes`; compressors have some memory besides. Throws Error(input) that names the file if
  /// it is no TIFF, and Error(io). `file` must outlive this.
  TiffFile(const storage::File& file, std::uint64_t most_bytes);
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;
  ~TiffFile();

  /// Returns the library's handle. After each call that can fail comes a check().
  TIFF* handle() { return tiff_.get(); }
  /// Throws the failure of the file that happened in the last calls; if they did not succeed, also
  /// Error(input) with the library's words.
  void check(bool succeeded);
  [[noreturn]] void fail(std::string_view message) const;

  const storage::File& file() const { return file_; }

  /// Returns a tag with one value, or its default; nothing if the directory has none.
  template <class Value>
  std::optional<Value> number(std::uint32_t tag) {
    Value value{};
    const bool found = TIFFGetFieldDefaulted(tiff_.get(), tag, &value) == 1;
    check(true);
    return found ? std::optional(value) : std::nullopt;
  }
  /// Return the values of a geo tag; empty if it is not there or of another type.
  std::vector<double> doubles(GeoTag tag);
  std::vector<std::uint16_t> shorts(GeoTag tag);
  std::string text(GeoTag tag);

  /// Goes to the directory at that byte.
  void select(std::uint64_t directory);
  /// Returns where the bytes of block `index` lie; none if the file leaves it out. Fails if they do
  /// not lie within the file.
  storage::File::Range place_of(std::uint32_t index);
  /// Reads and decodes block `index`, a strip or a tile, into `into`: all of its bytes, in this
  /// machine's order. Fails if it does not lie within the file, or gives fewer bytes.
  void read_block(std::uint32_t index, std::span<std::byte> into);

 private:
  struct Close {
    void operator()(TIFF* tiff) const;
  };
  struct Calls;

  /// Returns the tag's values if it has them in elements of `bytes` and of `type`.
  template <class Value>
  std::vector<Value> values(GeoTag tag, TIFFDataType type);

  const storage::File& file_;
  std::uint64_t position_ = 0;
  std::string message_;
  std::exception_ptr caught_;
  std::unique_ptr<TIFF, Close> tiff_;
};

}  // namespace meshhier::images
