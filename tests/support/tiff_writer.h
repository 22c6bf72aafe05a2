// TIFF files that libtiff writes into files of tests.
#pragma once

#include "base/error.h"
#include "images/tiff_file.h"
#include "storage/io/file.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <tiffio.h>

namespace meshhier::tests {

class TiffWriter {
 public:
  enum class Form : std::uint8_t { classic, big };

  /// Begins a file, which is empty, with the geo tags known. BigTIFF has no limit of 4 GB.
  TiffWriter(storage::File& file, Form form) : file_(file) {
    tiff_.reset(TIFFClientOpen("", form == Form::big ? "w8" : "w", this, read, write, seek, close,
                               size, nullptr, nullptr));
    check(tiff_ != nullptr && know_geo_tags(tiff_.get()));
  }

  TIFF* handle() { return tiff_.get(); }
  static void check(bool succeeded) {
    if (!succeeded)
      throw Error(ErrorCode::internal, "libtiff cannot write");
  }

 private:
  struct Close {
    void operator()(TIFF* tiff) const { TIFFCleanup(tiff); }
  };
  static TiffWriter& of(void* self) { return *static_cast<TiffWriter*>(self); }
  static tmsize_t read(void* self, void* into, tmsize_t bytes) {
    const std::size_t count = of(self).file_.read_at(
        of(self).position_, {static_cast<std::byte*>(into), static_cast<std::size_t>(bytes)});
    of(self).position_ += count;
    return static_cast<tmsize_t>(count);
  }
  static tmsize_t write(void* self, void* from, tmsize_t bytes) {
    of(self).file_.write_at(of(self).position_,
                            {static_cast<const std::byte*>(from), static_cast<std::size_t>(bytes)});
    of(self).position_ += static_cast<std::uint64_t>(bytes);
    return bytes;
  }
  static toff_t seek(void* self, toff_t offset, int whence) {
    const std::uint64_t from = whence == SEEK_CUR   ? of(self).position_
                               : whence == SEEK_END ? size(self)
                                                    : 0;
    return of(self).position_ = from + offset;
  }
  static toff_t size(void* self) { return of(self).file_.size(); }
  static int close(void* /*self*/) { return 0; }

  static TIFFFieldInfo geo_field(images::GeoTag tag, TIFFDataType type, const char* name) {
    const bool is_text = type == TIFF_ASCII;
    const short count = is_text ? TIFF_VARIABLE : TIFF_VARIABLE2;
    return {.field_tag = static_cast<std::uint32_t>(tag),
            .field_readcount = count,
            .field_writecount = count,
            .field_type = type,
            .field_bit = FIELD_CUSTOM,
            .field_oktochange = 1,
            .field_passcount = static_cast<unsigned char>(is_text ? 0 : 1),
            .field_name = const_cast<char*>(name)};
  }
  static bool know_geo_tags(TIFF* tiff) {
    using images::GeoTag;
    static const std::array fields = {
        geo_field(GeoTag::pixel_scale, TIFF_DOUBLE, "ModelPixelScale"),
        geo_field(GeoTag::tie_points, TIFF_DOUBLE, "ModelTiepoint"),
        geo_field(GeoTag::transformation, TIFF_DOUBLE, "ModelTransformation"),
        geo_field(GeoTag::key_directory, TIFF_SHORT, "GeoKeyDirectory"),
        geo_field(GeoTag::double_params, TIFF_DOUBLE, "GeoDoubleParams"),
        geo_field(GeoTag::ascii_params, TIFF_ASCII, "GeoASCIIParams"),
        geo_field(GeoTag::gdal_metadata, TIFF_ASCII, "GDALMetadata"),
        geo_field(GeoTag::gdal_nodata, TIFF_ASCII, "GDALNoDataValue")};
    return TIFFMergeFieldInfo(tiff, fields.data(), fields.size()) == 0;
  }

  storage::File& file_;
  std::uint64_t position_ = 0;
  std::unique_ptr<TIFF, Close> tiff_;
};

}  // namespace meshhier::tests
