// Heights in GeoTIFF, with what GDAL's tags say of them: scale, offset, unit, and the number that
// stands for no height; and with the mask or the alpha that says which cells are seen.
#include "images/tiff_pixels.h"
#include "mesh_io/blocked_raster.h"
#include "mesh_io/gdal_tags.h"
#include "mesh_io/geotiff_place.h"
#include "mesh_io/height_mask.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using images::GeoTag;
using images::TiffDirectory;
using images::TiffFile;
using images::TiffLayout;
using images::TiffPixels;
using images::TiffSamples;

/// A kind of samples, and how they become heights.
struct SampleRow {
  TiffSamples samples;
  std::uint32_t bits;
  /// Reads samples as they are; `absent`: the number that stands for no height.
  /// `stride`: bytes from one to the next.
  void (*convert)(const std::byte* from, std::size_t stride, std::optional<double> absent,
                  std::span<double> to);
  /// Returns the sample of a number.
  std::vector<std::byte> (*sample)(double value);
};

/// Returns the sample that a number is; nothing if it is none of the type.
template <class T>
std::optional<T> as_sample(double value) {
  if constexpr (std::is_floating_point_v<T>)
    return std::isnan(value) ? std::nullopt : std::optional(static_cast<T>(value));
  // The largest integer of 64 bits becomes 2^63 or 2^64, which are none.
  const bool is_one = value >= static_cast<double>(std::numeric_limits<T>::min()) &&
                      value <= static_cast<double>(std::numeric_limits<T>::max()) &&
                      value < 0x1p63 && value == std::trunc(value);
  return is_one ? std::optional(static_cast<T>(value)) : std::nullopt;
}

template <class T>
void convert_samples(const std::byte* from, std::size_t stride, std::optional<double> absent,
                     std::span<double> to) {
  const std::optional<T> none = absent ? as_sample<T>(*absent) : std::nullopt;
  const bool has_none = none.has_value();
  const T none_sample = none.value_or(T{});
  for (double& height : to) {
    T sample;
    std::memcpy(&sample, from, sizeof sample);
    from += stride;
    height = has_none && sample == none_sample ? std::numeric_limits<double>::quiet_NaN()
                                               : static_cast<double>(sample);
  }
}

template <class T>
std::vector<std::byte> sample_of(double value) {
  constexpr T kElse = std::is_floating_point_v<T> ? std::numeric_limits<T>::quiet_NaN() : T{};
  const T sample = as_sample<T>(value).value_or(kElse);
  std::vector<std::byte> bytes(sizeof sample);
  std::memcpy(bytes.data(), &sample, sizeof sample);
  return bytes;
}

template <class T>
constexpr SampleRow sample_row() {
  return {std::is_floating_point_v<T> ? TiffSamples::reals
          : std::is_signed_v<T>       ? TiffSamples::integers
                                      : TiffSamples::unsigned_integers,
          8 * sizeof(T), convert_samples<T>, sample_of<T>};
}

constexpr std::array kSampleRows = {sample_row<std::uint8_t>(),  sample_row<std::int8_t>(),
                                    sample_row<std::uint16_t>(), sample_row<std::int16_t>(),
                                    sample_row<std::uint32_t>(), sample_row<std::int32_t>(),
                                    sample_row<std::uint64_t>(), sample_row<std::int64_t>(),
                                    sample_row<float>(),         sample_row<double>()};

const SampleRow* row_of(const TiffLayout& layout) {
  const auto found = std::ranges::find_if(kSampleRows, [&](const SampleRow& row) {
    return row.samples == layout.samples && row.bits == layout.bits;
  });
  return found == kSampleRows.end() ? nullptr : &*found;
}

/// Whether a second band says which heights are seen.
bool has_alpha(const TiffLayout& layout) {
  return layout.bands == 2 && layout.alpha_band == 1;
}

/// Refuses what is no grid of heights.
void require_heights(const TiffLayout& layout, const std::filesystem::path& path) {
  if (layout.is_picture()) {
    fail_file(path,
              "is a picture, not heights; to show it on a surface, give the heights as the input "
              "and this by `--drape`");
  }
  if (has_alpha(layout) && layout.is_separate)
    fail_file(path, "has its alpha apart; `gdal_translate -b 1 -mask 2` makes a mask of it");
  if (layout.bands > 1 && !has_alpha(layout)) {
    fail_file(path, fmt::format("has {} bands; which of them are heights? `gdal_translate -b 1` "
                                "makes a file of the first one",
                                layout.bands));
  }
  if (row_of(layout) == nullptr) {
    fail_file(path, fmt::format("has samples of {} bits, expected integers or floats of 8 to 64; "
                                "`gdal_translate -ot Float32` makes such",
                                layout.bits));
  }
}

class GeoTiffRaster final : public BlockedRaster {
 public:
  GeoTiffRaster(std::unique_ptr<storage::File> file, storage::FileSystem& files)
      : file_(std::move(file)) {
    TiffFile tiff(*file_, images::kMostTiffHead);
    const auto all = images::tiff_directories(tiff);
    const TiffDirectory* const image = images::full_image(all);
    if (image == nullptr)
      tiff.fail("has overviews or masks alone, no image of full resolution");
    pixels_ = std::make_unique<TiffPixels>(*file_, image->offset);
    require_heights(pixels_->layout(), file_->path());
    tiff.select(image->offset);
    if (const TiffDirectory* const mask = images::mask_of(all, *image))
      mask_.emplace(*file_, mask->offset);
    read_head(tiff, all, files);
  }

  std::uint64_t row_bytes() const override {
    return BlockedRaster::row_bytes() + (mask_ ? mask_->row_bytes() : 0);
  }

 private:
  void read_head(TiffFile& tiff, const std::vector<TiffDirectory>& all,
                 storage::FileSystem& files) {
    const TiffLayout& layout = pixels_->layout();
    sample_ = row_of(layout);
    gdal_ = read_gdal_tags(tiff.text(GeoTag::gdal_metadata), tiff.text(GeoTag::gdal_nodata));
    RasterHead head{.path = file_->path(), .columns = layout.width, .rows = layout.height};
    GeoTiffPlace place = read_place(tiff, files);
    head.map = place.map;
    head.keys = std::move(place.keys);
    if (gdal_.metres)
      head.keys.height_unit = gdal_.metres;
    const bool is_on_lengths = head.keys.kind == geodesy::MapKind::lengths;
    to_metres_ = head.keys.height_unit.value_or(is_on_lengths ? head.keys.unit : 1);
    head.may_have_voids = gdal_.absent || layout.samples == TiffSamples::reals ||
                          mask_.has_value() || has_alpha(layout);
    warn(all, head);
    if (gdal_.absent)
      pixels_->set_absent(sample_->sample(*gdal_.absent));
    set(std::move(head), {layout.block_width, layout.block_height, layout.bands * layout.bits / 8});
  }

  void warn(const std::vector<TiffDirectory>& all, RasterHead& head) const {
    const auto others = std::ranges::count_if(all, &TiffDirectory::is_full);
    const auto say = [&](const std::string& text) {
      head.warnings.push_back(file_message(head.path, text));
    };
    if (others > 1)
      say(fmt::format("holds {} images; the first one is read", others));
    if (!gdal_.unknown_unit.empty()) {
      say(fmt::format("its heights are in {}, a unit that is not known: they are taken for metres",
                      in_quotes(gdal_.unknown_unit)));
    }
  }

  void decode(const BlockPlace& place, std::span<std::byte> into) const override {
    pixels_->read_block({place.column, place.row}, into);
  }

  void convert(const std::byte* from, std::span<double> heights) const override {
    const TiffLayout& layout = pixels_->layout();
    const std::size_t bytes = layout.bits / 8, stride = layout.bands * bytes;
    sample_->convert(from, stride, gdal_.absent, heights);
    if (has_alpha(layout))
      hide_transparent(from + bytes, stride, heights);
    const double scale = gdal_.scale * to_metres_, offset = gdal_.offset * to_metres_;
    if (scale == 1 && offset == 0)
      return;
    for (double& height : heights)
      height = height * scale + offset;
  }

  /// `alpha`: the first pixel's.
  void hide_transparent(const std::byte* alpha, std::size_t stride,
                        std::span<double> heights) const {
    const std::size_t bytes = pixels_->layout().bits / 8;
    for (double& height : heights) {
      if (std::all_of(alpha, alpha + bytes, [](std::byte b) { return b == std::byte{0}; }))
        height = std::numeric_limits<double>::quiet_NaN();
      alpha += stride;
    }
  }

  void hide(std::uint32_t row, std::uint32_t first, std::span<double> heights) const override {
    if (mask_)
      mask_->hide(row, first, heights);
  }

  std::unique_ptr<storage::File> file_;
  std::unique_ptr<TiffPixels> pixels_;
  std::optional<HeightMask> mask_;
  const SampleRow* sample_ = nullptr;
  GdalTags gdal_;
  double to_metres_ = 1;
};

}  // namespace

std::unique_ptr<HeightRaster> open_geotiff(storage::FileSystem& files,
                                           const std::filesystem::path& path) {
  return std::make_unique<GeoTiffRaster>(files.open(path), files);
}

}  // namespace meshhier::mesh_io
