#include "images/tiff_pixels.h"

#include <algorithm>
#include <utility>

namespace meshhier::images {
namespace {

constexpr std::uint64_t kMostTiffBlocks = std::uint64_t{1} << 22;
/// The cells of a block of rows that lie in the file as they are.
constexpr std::uint64_t kPlainCells = 65536;
constexpr const char* kRewrite =
    "; `gdal_translate -co TILED=YES -co BIGTIFF=IF_SAFER` rewrites it";

constexpr std::uint32_t kReducedBit = FILETYPE_REDUCEDIMAGE, kMaskBit = FILETYPE_MASK;

/// Returns a tag of 16 or 32 bits.
std::uint32_t tag_of(TiffFile& tiff, std::uint32_t tag) {
  return tiff.number<std::uint32_t>(tag).value_or(0);
}
std::uint32_t short_tag(TiffFile& tiff, std::uint32_t tag) {
  return tiff.number<std::uint16_t>(tag).value_or(0);
}

/// Returns the first band that is alpha; 0: none.
std::uint32_t alpha_band_of(TiffFile& tiff, std::uint32_t bands) {
  std::uint16_t count = 0;
  const std::uint16_t* kinds = nullptr;
  const bool found = TIFFGetField(tiff.handle(), TIFFTAG_EXTRASAMPLES, &count, &kinds) == 1;
  tiff.check(true);
  for (std::uint32_t i = 0; found && i < count && count <= bands; ++i) {
    if (kinds[i] == EXTRASAMPLE_ASSOCALPHA || kinds[i] == EXTRASAMPLE_UNASSALPHA)
      return bands - count + i;
  }
  return 0;
}

void swap_samples(std::span<std::byte> bytes, std::size_t size) {
  for (std::size_t i = 0; i + size <= bytes.size(); i += size)
    std::ranges::reverse(bytes.subspan(i, size));
}

}  // namespace

const TiffDirectory* full_image(std::span<const TiffDirectory> images) {
  const auto found = std::ranges::find_if(images, &TiffDirectory::is_full);
  return found == images.end() ? nullptr : &*found;
}

const TiffDirectory* mask_of(std::span<const TiffDirectory> images, const TiffDirectory& image) {
  const auto found = std::ranges::find_if(images, [&](const TiffDirectory& one) {
    return one.is_mask && one.width == image.width && one.height == image.height;
  });
  return found == images.end() ? nullptr : &*found;
}

std::vector<TiffDirectory> tiff_directories(TiffFile& tiff, std::size_t most) {
  std::vector<TiffDirectory> all;
  do {
    const std::uint32_t type = tag_of(tiff, TIFFTAG_SUBFILETYPE);
    all.push_back({TIFFCurrentDirOffset(tiff.handle()), tag_of(tiff, TIFFTAG_IMAGEWIDTH),
                   tag_of(tiff, TIFFTAG_IMAGELENGTH), (type & kReducedBit) != 0,
                   (type & kMaskBit) != 0});
  } while (all.size() < most && TIFFReadDirectory(tiff.handle()) == 1);
  tiff.check(true);
  return all;
}

bool TiffLayout::is_picture() const {
  const bool is_of_bytes = bits == 8 && samples != TiffSamples::reals;
  const bool is_grey =
      photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_MINISWHITE;
  return !is_grey || (bands >= 3 && is_of_bytes) || compression == COMPRESSION_JPEG;
}

/// A handle for the time of a call.
class TiffPixels::Lease {
 public:
  explicit Lease(const TiffPixels& pixels) : pixels_(pixels) {
    {
      const std::lock_guard lock(pixels.mutex_);
      if (!pixels.idle_.empty()) {
        tiff_ = std::move(pixels.idle_.back());
        pixels.idle_.pop_back();
      }
    }
    if (tiff_ == nullptr)
      tiff_ = pixels.open();
  }
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;
  ~Lease() {
    const std::lock_guard lock(pixels_.mutex_);
    pixels_.idle_.push_back(std::move(tiff_));
  }
  TiffFile& operator*() { return *tiff_; }

 private:
  const TiffPixels& pixels_;
  std::unique_ptr<TiffFile> tiff_;
};

TiffPixels::TiffPixels(const storage::File& file, std::uint64_t offset)
    : file_(file), offset_(offset) {
  auto tiff = open();
  read_layout(*tiff);
  read_blocks(*tiff);
  idle_.push_back(std::move(tiff));
}

TiffPixels::~TiffPixels() = default;

std::unique_ptr<TiffFile> TiffPixels::open() const {
  auto tiff = std::make_unique<TiffFile>(file_, kMostTiffBlock + (std::uint64_t{16} << 20));
  tiff->select(offset_);
  if (short_tag(*tiff, TIFFTAG_COMPRESSION) == COMPRESSION_JPEG &&
      short_tag(*tiff, TIFFTAG_PHOTOMETRIC) == PHOTOMETRIC_YCBCR)
    tiff->check(TIFFSetField(tiff->handle(), TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB) == 1);
  return tiff;
}

void TiffPixels::read_layout(TiffFile& tiff) {
  layout_.width = tag_of(tiff, TIFFTAG_IMAGEWIDTH);
  layout_.height = tag_of(tiff, TIFFTAG_IMAGELENGTH);
  layout_.bands = short_tag(tiff, TIFFTAG_SAMPLESPERPIXEL);
  layout_.bits = short_tag(tiff, TIFFTAG_BITSPERSAMPLE);
  layout_.photometric = short_tag(tiff, TIFFTAG_PHOTOMETRIC);
  layout_.compression = short_tag(tiff, TIFFTAG_COMPRESSION);
  layout_.is_separate = short_tag(tiff, TIFFTAG_PLANARCONFIG) == PLANARCONFIG_SEPARATE;
  if (layout_.width == 0 || layout_.height == 0 || layout_.bands == 0 || layout_.bits == 0 ||
      layout_.bits > 64)
    tiff.fail("has no size, or samples of no size: this is no image");
  const std::uint32_t format = short_tag(tiff, TIFFTAG_SAMPLEFORMAT);
  if (format == SAMPLEFORMAT_COMPLEXIEEEFP || format == SAMPLEFORMAT_COMPLEXINT)
    tiff.fail("has complex numbers");
  layout_.samples = format == SAMPLEFORMAT_IEEEFP ? TiffSamples::reals
                    : format == SAMPLEFORMAT_INT  ? TiffSamples::integers
                                                  : TiffSamples::unsigned_integers;
  layout_.alpha_band = alpha_band_of(tiff, layout_.bands);
  is_swapped_ = TIFFIsByteSwapped(tiff.handle()) != 0;
}

/// Returns whether the bytes of rows are those of samples, but for their order.
bool TiffPixels::has_plain_rows(TiffFile& tiff) const {
  return layout_.compression == COMPRESSION_NONE && layout_.bits % 8 == 0 &&
         layout_.block_height > 0 && short_tag(tiff, TIFFTAG_FILLORDER) != FILLORDER_LSB2MSB;
}

void TiffPixels::read_blocks(TiffFile& tiff) {
  if (TIFFIsCODECConfigured(static_cast<std::uint16_t>(layout_.compression)) == 0) {
    tiff.fail("is compressed in a way that is not read (TIFF's number " +
              std::to_string(layout_.compression) +
              "); `gdal_translate -co COMPRESS=ZSTD` changes it");
  }
  if (TIFFIsTiled(tiff.handle()) != 0) {
    layout_.block_width = tag_of(tiff, TIFFTAG_TILEWIDTH);
    layout_.block_height = tag_of(tiff, TIFFTAG_TILELENGTH);
  } else {
    layout_.block_width = layout_.width;
    layout_.block_height = std::min(layout_.height, tag_of(tiff, TIFFTAG_ROWSPERSTRIP));
    if (has_plain_rows(tiff)) {
      plain_strip_ = layout_.block_height;
      const std::uint64_t rows = std::max<std::uint64_t>(1, kPlainCells / layout_.width);
      layout_.block_height =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(rows, layout_.height));
    }
  }
  if (layout_.block_width == 0 || layout_.block_height == 0)
    tiff.fail("has blocks without a size");
  // Sizes are below 2^32, bands and bits below 2^16: products of two of them fit.
  const std::uint64_t blocks = std::uint64_t{layout_.columns()} * layout_.rows();
  if (blocks > kMostTiffBlocks / (layout_.is_separate ? layout_.bands : 1))
    tiff.fail("has " + std::to_string(blocks) + " blocks, too many" + kRewrite);
  if (layout_.block_stride() > kMostTiffBlock / layout_.block_height) {
    tiff.fail("has blocks of " + std::to_string(layout_.block_width) + " x " +
              std::to_string(layout_.block_height) + " cells, which must be decoded whole" +
              kRewrite);
  }
}

std::uint32_t TiffPixels::index_of(const Block& block) const {
  return (block.band * layout_.rows() + block.row) * layout_.columns() + block.column;
}

void TiffPixels::fill_absent(std::span<std::byte> into) const {
  for (std::size_t i = 0; i < into.size(); ++i)
    into[i] = absent_.empty() ? std::byte{0} : absent_[i % absent_.size()];
}

void TiffPixels::read_block(const Block& block, std::span<std::byte> into) const {
  Lease lease(*this);
  TiffFile& tiff = *lease;
  if (plain_strip_ > 0)
    return read_plain_rows(tiff, block, into);
  const std::uint32_t index = index_of(block);
  if (tiff.place_of(index).bytes == 0)
    return fill_absent(into);
  const bool is_last_strip = TIFFIsTiled(tiff.handle()) == 0 && block.row + 1 == layout_.rows();
  const std::uint64_t rows = is_last_strip
                                 ? layout_.height - std::uint64_t{block.row} * layout_.block_height
                                 : layout_.block_height;
  tiff.read_block(index, into.first(rows * layout_.block_stride()));
}

/// A block's rows may lie in several strips, and a strip's in several blocks.
void TiffPixels::read_plain_rows(TiffFile& tiff, const Block& block,
                                 std::span<std::byte> into) const {
  const std::uint64_t stride = layout_.block_stride();
  const std::uint32_t strips = (layout_.height - 1) / plain_strip_ + 1;
  std::uint64_t row = std::uint64_t{block.row} * layout_.block_height;
  const std::uint64_t end = std::min<std::uint64_t>(layout_.height, row + layout_.block_height);
  while (row < end) {
    const std::uint64_t strip = row / plain_strip_;
    const std::uint64_t rows = std::min(end, (strip + 1) * plain_strip_) - row;
    const std::span<std::byte> to = into.first(rows * stride);
    read_plain(tiff, static_cast<std::uint32_t>(block.band * strips + strip),
               (row - strip * plain_strip_) * stride, to);
    into = into.subspan(to.size());
    row += rows;
  }
}

void TiffPixels::read_plain(TiffFile& tiff, std::uint32_t strip, std::uint64_t skipped,
                            std::span<std::byte> into) const {
  const storage::File::Range place = tiff.place_of(strip);
  if (place.bytes == 0)
    return fill_absent(into);
  if (skipped + into.size() > place.bytes)
    tiff.fail("strip " + std::to_string(strip) + " has fewer bytes than its rows (truncated?)");
  file_.read_exact(place.offset + skipped, into);
  if (is_swapped_)
    swap_samples(into, layout_.bits / 8);
}

}  // namespace meshhier::images
