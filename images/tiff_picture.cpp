#include "images/tiff_picture.h"

#include "base/error.h"
#include "images/tiff_pixels.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::images {
namespace {

/// The most memory of a row of decoded blocks, with its mask.
constexpr std::uint64_t kMostBand = std::uint64_t{2} << 30;
constexpr std::uint32_t kFull16 = 65535, kFull8 = 255;

/// Returns 16 bits as 8, rounded.
std::uint8_t to_8_bits(std::uint32_t value) {
  return static_cast<std::uint8_t>((value * kFull8 + kFull16 / 2) / kFull16);
}

std::uint8_t mixed(std::uint32_t colour, std::uint32_t ground, std::uint32_t alpha) {
  return static_cast<std::uint8_t>((colour * alpha + ground * (kFull8 - alpha) + kFull8 / 2) /
                                   kFull8);
}

/// The colours that values stand for.
using Palette = std::vector<std::array<std::uint8_t, 3>>;

Palette read_palette(TiffFile& tiff, std::uint32_t bits) {
  std::uint16_t *red = nullptr, *green = nullptr, *blue = nullptr;
  if (TIFFGetField(tiff.handle(), TIFFTAG_COLORMAP, &red, &green, &blue) != 1)
    tiff.fail("has a palette without colours");
  Palette palette(std::size_t{1} << bits);
  for (std::size_t i = 0; i < palette.size(); ++i)
    palette[i] = {to_8_bits(red[i]), to_8_bits(green[i]), to_8_bits(blue[i])};
  return palette;
}

/// A row of decoded blocks of an image, from which rows are taken.
class Band {
 public:
  explicit Band(const TiffPixels& pixels) : pixels_(pixels) {}

  std::uint64_t bytes() const {
    const TiffLayout& form = pixels_.layout();
    return form.block_bytes() * form.columns() * (form.is_separate ? form.bands : 1);
  }

  /// Reads the blocks that row `y` lies in, unless they are there.
  void go_to(std::uint32_t y) {
    const TiffLayout& form = pixels_.layout();
    row_ = y;
    if (const std::uint32_t wanted = y / form.block_height; wanted != block_row_ || blocks_.empty())
      read(wanted);
  }

  /// Returns the first sample of a pixel's band, and of a pixel's bits if they are few.
  const std::byte* sample(std::uint32_t x, std::uint32_t band) const {
    const TiffLayout& form = pixels_.layout();
    const std::uint64_t block =
        std::uint64_t{form.is_separate ? band : 0} * form.columns() + x / form.block_width;
    const std::uint64_t in_row = form.is_separate
                                     ? x % form.block_width
                                     : std::uint64_t{x % form.block_width} * form.bands + band;
    return blocks_.data() + block * form.block_bytes() +
           row_ % form.block_height * form.block_stride() + in_row * form.bits / 8;
  }

 private:
  void read(std::uint32_t block_row) {
    const TiffLayout& form = pixels_.layout();
    blocks_.resize(bytes());
    std::span<std::byte> left = blocks_;
    for (std::uint32_t band = 0; band < (form.is_separate ? form.bands : 1); ++band) {
      for (std::uint32_t column = 0; column < form.columns(); ++column) {
        pixels_.read_block({column, block_row, band}, left.first(form.block_bytes()));
        left = left.subspan(form.block_bytes());
      }
    }
    block_row_ = block_row;
  }

  const TiffPixels& pixels_;
  std::vector<std::byte> blocks_;
  std::uint32_t block_row_ = 0, row_ = 0;
};

class FramedTiff final : public ImageReader {
 public:
  FramedTiff(std::unique_ptr<storage::File> file, std::string name)
      : file_(std::move(file)), name_(std::move(name)) {
    TiffFile tiff(*file_, kMostTiffHead);
    const auto all = tiff_directories(tiff);
    const TiffDirectory* const image = full_image(all);
    if (image == nullptr)
      fail("has overviews or masks alone, no picture of full resolution");
    pixels_ = std::make_unique<TiffPixels>(*file_, image->offset);
    tiff.select(image->offset);
    read_form(tiff);
    open_mask(all, *image);
    describe();
  }

  const ImageInfo& info() const override { return info_; }
  void read_rows(std::uint8_t* rows, std::uint32_t count) override;

 private:
  const TiffLayout& form() const { return pixels_->layout(); }
  [[noreturn]] void fail(std::string_view message) const {
    throw Error(ErrorCode::input, name_ + ": " + std::string(message));
  }
  void read_form(TiffFile& tiff);
  void open_mask(const std::vector<TiffDirectory>& all, const TiffDirectory& image);
  void describe();
  std::uint32_t raw(std::uint32_t x, std::uint32_t band) const;
  std::uint32_t alpha_at(std::uint32_t x) const;
  bool is_masked(std::uint32_t x) const;
  void read_pixel(std::uint32_t x, std::uint8_t* to) const;

  std::unique_ptr<storage::File> file_;
  std::string name_;
  std::unique_ptr<TiffPixels> pixels_, mask_pixels_;
  std::optional<Band> band_, mask_;
  ImageInfo info_;
  Palette palette_;
  std::uint32_t colours_ = 3;            ///< bands of colour: 1 or 3
  bool is_inverted_ = false;             ///< 0 is white
  std::optional<std::uint32_t> absent_;  ///< the number for no colour, in all bands
  std::uint32_t next_row_ = 0;
};

void FramedTiff::read_form(TiffFile& tiff) {
  const bool is_jpeg_colour =
      form().photometric == PHOTOMETRIC_YCBCR && form().compression == COMPRESSION_JPEG;
  const bool is_palette = form().photometric == PHOTOMETRIC_PALETTE;
  is_inverted_ = form().photometric == PHOTOMETRIC_MINISWHITE;
  const bool is_grey = is_inverted_ || form().photometric == PHOTOMETRIC_MINISBLACK;
  if ((form().bits != 8 && form().bits != 16) || form().samples == TiffSamples::reals)
    fail(
        "has colours of other forms than 8 or 16 bits; `gdal_translate -ot Byte -scale` makes "
        "bytes");
  if (!is_jpeg_colour && !is_palette && !is_grey && form().photometric != PHOTOMETRIC_RGB)
    fail("has colours of a kind that is not read; `gdal_translate -co PHOTOMETRIC=RGB` changes it");
  // Greys of three bands and more are colours without their name.
  colours_ = is_palette || (is_grey && form().bands < 3) ? 1 : 3;
  if (form().bands < colours_)
    fail("has fewer bands than colours");
  if (is_palette)
    palette_ = read_palette(tiff, form().bits);
  const std::string nodata = tiff.text(GeoTag::gdal_nodata);
  std::uint32_t value = 0;
  const auto parsed = std::from_chars(nodata.data(), nodata.data() + nodata.size(), value);
  if (parsed.ec == std::errc() && parsed.ptr == nodata.data() + nodata.size())
    absent_ = value;
}

void FramedTiff::open_mask(const std::vector<TiffDirectory>& all, const TiffDirectory& image) {
  const TiffDirectory* const mask = mask_of(all, image);
  if (mask == nullptr)
    return;
  mask_pixels_ = std::make_unique<TiffPixels>(*file_, mask->offset);
  const TiffLayout& mask_form = mask_pixels_->layout();
  if (mask_form.bands != 1 || (mask_form.bits != 1 && mask_form.bits != 8))
    fail("has a mask that is not of one band of 1 or 8 bits");
  mask_.emplace(*mask_pixels_);
}

void FramedTiff::describe() {
  constexpr std::uint32_t kMostSide = kMaxSourceSide - 2 * kPictureFrame;
  if (form().width > kMostSide || form().height > kMostSide) {
    fail("has " + std::to_string(form().width) + " x " + std::to_string(form().height) +
         " pixels, more than " + std::to_string(kMostSide) +
         " on a side; `gdal_translate -outsize` makes it smaller");
  }
  band_.emplace(*pixels_);
  const std::uint64_t bytes = band_->bytes() + (mask_ ? mask_->bytes() : 0);
  if (bytes > kMostBand)
    fail("has blocks that are too large; `gdal_translate -co TILED=YES` makes smaller ones");
  info_ = {.format = ImageFormat::png,
           .width = form().width + 2 * kPictureFrame,
           .height = form().height + 2 * kPictureFrame,
           .channels = 3,
           .decoder_bytes = bytes};
}

std::uint32_t FramedTiff::raw(std::uint32_t x, std::uint32_t band) const {
  const std::byte* from = band_->sample(x, band);
  if (form().bits == 8)
    return std::to_integer<std::uint32_t>(*from);
  std::uint16_t value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

bool FramedTiff::is_masked(std::uint32_t x) const {
  constexpr unsigned kBits = 8;
  if (mask_) {
    const bool is_bit = mask_pixels_->layout().bits == 1;
    const unsigned byte = std::to_integer<unsigned>(*mask_->sample(x, 0));
    const unsigned in_block = x % mask_pixels_->layout().block_width;
    if ((is_bit ? byte >> (kBits - 1 - in_block % kBits) & 1U : byte) == 0)
      return true;
  }
  for (std::uint32_t band = 0; band < colours_; ++band) {
    if (!absent_ || raw(x, band) != *absent_)
      return false;
  }
  return true;
}

std::uint32_t FramedTiff::alpha_at(std::uint32_t x) const {
  if (is_masked(x))
    return 0;
  if (form().alpha_band < colours_)
    return kFull8;
  const std::uint32_t alpha = raw(x, form().alpha_band);
  return form().bits == 8 ? alpha : to_8_bits(alpha);
}

void FramedTiff::read_pixel(std::uint32_t x, std::uint8_t* to) const {
  const std::uint32_t alpha = alpha_at(x);
  for (std::uint32_t c = 0; c < kBareGround.size(); ++c) {
    std::uint32_t value = raw(x, colours_ == 1 ? 0 : c);
    if (!palette_.empty())
      value = palette_[value][c];
    else if (form().bits != 8)
      value = to_8_bits(value);
    to[c] = mixed(is_inverted_ ? kFull8 - value : value, kBareGround[c], alpha);
  }
}

void FramedTiff::read_rows(std::uint8_t* rows, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i, ++next_row_) {
    std::uint8_t* to = rows + std::size_t{i} * info_.width * kBareGround.size();
    for (std::uint32_t x = 0; x < info_.width; ++x)
      std::ranges::copy(kBareGround, to + x * kBareGround.size());
    const bool is_frame = next_row_ < kPictureFrame || next_row_ >= form().height + kPictureFrame;
    if (is_frame)
      continue;
    band_->go_to(next_row_ - kPictureFrame);
    if (mask_)
      mask_->go_to(next_row_ - kPictureFrame);
    for (std::uint32_t x = 0; x < form().width; ++x)
      read_pixel(x, to + (x + kPictureFrame) * kBareGround.size());
  }
}

}  // namespace

std::unique_ptr<ImageReader> open_framed_tiff(std::unique_ptr<storage::File> file,
                                              const std::string& name) {
  return std::make_unique<FramedTiff>(std::move(file), name);
}

}  // namespace meshhier::images
