// TIFF files of any form, made with the library.
#pragma once

#include "support/memory_files.h"
#include "support/tiff_writer.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace meshhier::tests {

/// The form of a file, and where it lies.
struct TiffForm {
  std::uint32_t tile = 0;  ///< side of tiles; 0: strips
  std::uint32_t rows_of_strip = 3;
  std::uint16_t compression = COMPRESSION_NONE;
  std::uint16_t predictor = PREDICTOR_NONE;
  std::uint16_t photometric = PHOTOMETRIC_MINISBLACK;
  std::uint16_t bands = 1;
  bool has_alpha = false;  ///< the last band
  TiffWriter::Form form = TiffWriter::Form::classic;
  std::string nodata{}, metadata{};
  std::vector<double> matrix{};  ///< ModelTransformation; else the two that follow
  std::array<double, 3> scale{10, 10, 0};
  std::array<double, 6> tie{0, 0, 0, 500000, 5300000, 0};
  /// UTM zone 33 N, in metres, places of corners.
  std::vector<std::uint16_t> keys{1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32633};
  std::uint32_t subfile = 0;
  bool has_place = true;  ///< else no tag says where it lies
};

template <class T>
constexpr std::uint16_t tiff_sample_format() {
  return std::is_floating_point_v<T> ? SAMPLEFORMAT_IEEEFP
         : std::is_signed_v<T>       ? SAMPLEFORMAT_INT
                                     : SAMPLEFORMAT_UINT;
}

/// Makes geo tags known to an image behind the first one: the library forgets them there.
inline void know_tags_again(TIFF* tiff) {
  static char name[] = "geo";
  const auto field = [](images::GeoTag tag, TIFFDataType type) {
    return TIFFFieldInfo{static_cast<std::uint32_t>(tag),
                         TIFF_VARIABLE2,
                         TIFF_VARIABLE2,
                         type,
                         FIELD_CUSTOM,
                         1,
                         1,
                         name};
  };
  static const std::array fields = {field(images::GeoTag::pixel_scale, TIFF_DOUBLE),
                                    field(images::GeoTag::tie_points, TIFF_DOUBLE),
                                    field(images::GeoTag::key_directory, TIFF_SHORT)};
  TIFFMergeFieldInfo(tiff, fields.data(), fields.size());
}

/// Writes the head of an image of `width` columns.
template <class T>
void put_tiff_head(TIFF* tiff, const TiffForm& form, std::uint32_t width, std::uint32_t height) {
  const auto set = [&](std::uint32_t tag, auto... values) { TIFFSetField(tiff, tag, values...); };
  set(TIFFTAG_SUBFILETYPE, form.subfile);
  set(TIFFTAG_IMAGEWIDTH, width);
  set(TIFFTAG_IMAGELENGTH, height);
  set(TIFFTAG_BITSPERSAMPLE, 8 * sizeof(T));
  set(TIFFTAG_SAMPLEFORMAT, tiff_sample_format<T>());
  set(TIFFTAG_SAMPLESPERPIXEL, form.bands);
  set(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  set(TIFFTAG_PHOTOMETRIC, form.photometric);
  set(TIFFTAG_COMPRESSION, form.compression);
  if (form.predictor != PREDICTOR_NONE)
    set(TIFFTAG_PREDICTOR, form.predictor);
  if (form.has_alpha) {
    const std::uint16_t alpha = EXTRASAMPLE_UNASSALPHA;
    set(TIFFTAG_EXTRASAMPLES, 1, &alpha);
  }
  if (form.tile > 0) {
    set(TIFFTAG_TILEWIDTH, form.tile);
    set(TIFFTAG_TILELENGTH, form.tile);
  } else {
    set(TIFFTAG_ROWSPERSTRIP, form.rows_of_strip);
  }
  const auto geo = [](images::GeoTag tag) { return static_cast<std::uint32_t>(tag); };
  if (!form.has_place) {
  } else if (!form.matrix.empty()) {
    set(geo(images::GeoTag::transformation), static_cast<int>(form.matrix.size()),
        form.matrix.data());
  } else {
    set(geo(images::GeoTag::pixel_scale), 3, form.scale.data());
    set(geo(images::GeoTag::tie_points), 6, form.tie.data());
  }
  if (!form.keys.empty())
    set(geo(images::GeoTag::key_directory), static_cast<int>(form.keys.size()), form.keys.data());
  if (!form.nodata.empty())
    set(geo(images::GeoTag::gdal_nodata), form.nodata.c_str());
  if (!form.metadata.empty())
    set(geo(images::GeoTag::gdal_metadata), form.metadata.c_str());
}

/// Writes an image of `width` columns.
template <class T>
void put_tiff_image(TiffWriter& file, const TiffForm& form, std::uint32_t width,
                    std::span<const T> samples) {
  const auto height = static_cast<std::uint32_t>(samples.size() / width / form.bands);
  TIFF* tiff = file.handle();
  put_tiff_head<T>(tiff, form, width, height);
  const std::uint32_t side = form.tile > 0 ? form.tile : width;
  const std::uint32_t rows = form.tile > 0 ? form.tile : form.rows_of_strip;
  std::uint32_t block = 0;
  for (std::uint32_t y = 0; y < height; y += rows) {
    for (std::uint32_t x = 0; x < width; x += side, ++block) {
      const std::uint32_t block_rows = form.tile > 0 ? rows : std::min(rows, height - y);
      std::vector<T> bytes(std::size_t{side} * block_rows * form.bands);
      for (std::uint32_t r = 0; r < block_rows && y + r < height; ++r) {
        const std::size_t from = (std::size_t{y + r} * width + x) * form.bands;
        const std::size_t count = std::size_t{std::min(side, width - x)} * form.bands;
        std::memcpy(bytes.data() + std::size_t{r} * side * form.bands, samples.data() + from,
                    count * sizeof(T));
      }
      const auto size = static_cast<tmsize_t>(bytes.size() * sizeof(T));
      file.check((form.tile > 0 ? TIFFWriteEncodedTile(tiff, block, bytes.data(), size)
                                : TIFFWriteEncodedStrip(tiff, block, bytes.data(), size)) >= 0);
    }
  }
  file.check(TIFFWriteDirectory(tiff) == 1);
}

/// Writes a file of one image.
template <class T>
void put_tiff(MemoryFiles& files, const std::filesystem::path& path, const TiffForm& form,
              std::uint32_t width, const std::vector<T>& samples) {
  const auto file = files.create(path);
  TiffWriter tiff(*file, form.form);
  put_tiff_image<T>(tiff, form, width, samples);
  tiff.check(TIFFFlush(tiff.handle()) == 1);
}

}  // namespace meshhier::tests
