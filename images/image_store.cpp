#include "images/image_store.h"

#include "images/block_cache.h"
#include "images/block_grid.h"
#include "images/pyramid_writer.h"
#include "images/wrapped_run.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::images {
namespace {

static_assert(ImageStore::kBlockSide == BlockGrid::kBlockSide);

BlockGrid grid_of(const ImageInfo& info) {
  return {{info.width, info.height}, info.channels};
}

bool is_sound(const StoredImage& image) {
  const ImageInfo& info = image.info;
  const auto is_side = [](std::uint32_t side) { return side >= 1 && side <= kMaxSourceSide; };
  return is_side(info.width) && is_side(info.height) &&
         (info.channels == 3 || info.channels == 4) &&
         image.strips.size() == grid_of(info).strips();
}

/// Part of a block and where it goes.
struct BlockPart {
  std::span<const std::uint32_t> columns, rows;  ///< numbers in the picture
  std::uint32_t block_width = 0;
  std::uint32_t channels = 0;  ///< channels of the block
  Image& into;
  std::uint32_t at_x = 0, at_y = 0;
};

void copy_texel(const std::uint8_t* from, std::uint32_t channels, Image& into, std::uint32_t x,
                std::uint32_t y) {
  std::uint8_t* to = into.at(x, y);
  std::copy_n(from, 3, to);
  if (into.channels == 4)
    to[3] = channels == 4 ? from[3] : 255;
}

/// Within one block a run never leaps to the right: it is straight if its ends are so far apart.
bool is_straight(std::span<const std::uint32_t> run) {
  return run.back() - run.front() == run.size() - 1;
}

void copy_part(const BlockPart& part, const std::uint8_t* block) {
  const bool is_whole_copy = part.into.channels == part.channels && is_straight(part.columns);
  for (std::uint32_t y = 0; y < part.rows.size(); ++y) {
    const auto texel = [&](std::size_t x) {
      const std::size_t row = part.rows[y] % BlockGrid::kBlockSide;
      const std::size_t column = part.columns[x] % BlockGrid::kBlockSide;
      return block + (row * part.block_width + column) * part.channels;
    };
    if (is_whole_copy) {
      std::memcpy(part.into.at(part.at_x, part.at_y + y), texel(0),
                  part.columns.size() * part.channels);
      continue;
    }
    for (std::uint32_t x = 0; x < part.columns.size(); ++x)
      copy_texel(texel(x), part.channels, part.into, part.at_x + x, part.at_y + y);
  }
}

}  // namespace

struct ImageStore::Impl {
  Impl(storage::ScratchFile& file, std::uint64_t cache_bytes) : scratch(file), cache(cache_bytes) {}

  bool is_there(const StoredImage& image) const;
  /// Checks a strip in a mounted file the first time it is used. Throws Error(corrupt).
  void check(std::uint32_t image, std::uint32_t strip, std::size_t bytes);
  void read_block(std::uint32_t image, std::uint32_t level, std::uint32_t column, std::uint32_t row,
                  const BlockPart& part);

  storage::ScratchFile& scratch;
  BlockCache cache;
  std::vector<StoredImage> images;
  std::mutex mutex;
  std::set<std::pair<std::uint32_t, std::uint32_t>> checked;  ///< image and strip
};

void ImageStore::Impl::check(std::uint32_t image, std::uint32_t strip, std::size_t bytes) {
  const StoredStrip& stored = images[image].strips[strip];
  if (!storage::ScratchFile::is_mounted(stored.offset))
    return;
  const std::lock_guard lock(mutex);  // one strip at a time is in memory
  if (checked.contains({image, strip}))
    return;
  std::vector<std::byte> read(bytes);
  scratch.read(stored.offset, read);
  if (storage::checksum(read) != stored.checksum)
    throw scratch.changed(stored.offset);
  checked.insert({image, strip});
}

bool ImageStore::Impl::is_there(const StoredImage& image) const {
  const BlockGrid grid = grid_of(image.info);
  auto strip = image.strips.begin();
  std::vector<std::byte> bytes(grid.strip_bytes(0, 0));
  for (std::uint32_t level = 0; level < grid.levels(); ++level) {
    const std::uint32_t rows = grid.first_strip(level + 1) - grid.first_strip(level);
    for (std::uint32_t row = 0; row < rows; ++row, ++strip) {
      const auto read = std::span(bytes).first(grid.strip_bytes(level, row));
      if (!scratch.claim(strip->offset, read.size()))
        return false;
      if (storage::ScratchFile::is_mounted(strip->offset))
        continue;
      scratch.read(strip->offset, read);
      if (storage::checksum(read) != strip->checksum)
        return false;
    }
  }
  return true;
}

void ImageStore::Impl::read_block(std::uint32_t image, std::uint32_t level, std::uint32_t column,
                                  std::uint32_t row, const BlockPart& part) {
  const BlockGrid grid = grid_of(images[image].info);
  const std::uint32_t strip = grid.first_strip(level) + row;
  const std::uint64_t key = std::uint64_t{image} << 32 | strip << 16 | column;
  const auto copy = [&](const std::byte* block) {
    copy_part(part, reinterpret_cast<const std::uint8_t*>(block));
  };
  if (cache.use(key, copy))
    return;
  check(image, strip, grid.strip_bytes(level, row));
  std::vector<std::byte> block(std::size_t{part.block_width} * grid.rows(level, row) *
                               grid.channels());
  scratch.read(images[image].strips[strip].offset + grid.offset(level, column, row), block);
  copy(block.data());
  cache.put(key, std::move(block));
}

ImageStore::ImageStore(storage::ScratchFile& scratch, std::uint64_t cache_bytes)
    : impl_(std::make_unique<Impl>(scratch, cache_bytes)) {}

ImageStore::~ImageStore() = default;

StoredImage ImageStore::write(ImageReader& reader, const Step& step) const {
  const ImageInfo& info = reader.info();
  PyramidWriter writer(impl_->scratch, info);
  std::vector<std::uint8_t> row(std::size_t{info.width} * info.channels);
  for (std::uint32_t y = 0; y < info.height; ++y) {
    reader.read_rows(row.data(), 1);
    writer.put_row(row.data());
    if ((y + 1) % kBlockSide == 0 || y + 1 == info.height)
      step(std::uint64_t{info.width} * (y % kBlockSide + 1));
  }
  return writer.finish();
}

void ImageStore::add(StoredImage written) {
  impl_->images.push_back(std::move(written));
}

bool ImageStore::restore(std::span<const StoredImage> images) {
  assert(impl_->images.empty());
  std::vector<StoredImage> placed(images.begin(), images.end());
  for (StoredImage& image : placed) {
    for (StoredStrip& strip : image.strips)
      strip.offset = impl_->scratch.placed(strip.offset);
    if (!is_sound(image) || !impl_->is_there(image))
      return false;
  }
  impl_->images = std::move(placed);
  return true;
}

std::size_t ImageStore::size() const {
  return impl_->images.size();
}

const ImageInfo& ImageStore::info(std::uint32_t image) const {
  return stored(image).info;
}

const StoredImage& ImageStore::stored(std::uint32_t image) const {
  return impl_->images[image];
}

std::uint32_t ImageStore::levels(std::uint32_t image) const {
  return grid_of(info(image)).levels();
}

void ImageStore::read(const TexelRect& rect, Image& into, std::uint32_t at_x,
                      std::uint32_t at_y) const {
  const BlockGrid grid = grid_of(info(rect.image));
  const TexelSize size = grid.size(rect.level);
  const auto columns = wrapped_run(rect.x, rect.width, size.width, rect.wrap_u);
  const auto rows = wrapped_run(rect.y, rect.height, size.height, rect.wrap_v);
  const std::vector<BlockRun> column_runs = block_runs(columns);
  for (const BlockRun& y : block_runs(rows)) {
    for (const BlockRun& x : column_runs) {
      const BlockPart part{.columns = std::span(columns).subspan(x.begin, x.end - x.begin),
                           .rows = std::span(rows).subspan(y.begin, y.end - y.begin),
                           .block_width = grid.columns(rect.level, x.block),
                           .channels = grid.channels(),
                           .into = into,
                           .at_x = at_x + static_cast<std::uint32_t>(x.begin),
                           .at_y = at_y + static_cast<std::uint32_t>(y.begin)};
      impl_->read_block(rect.image, rect.level, x.block, y.block, part);
    }
  }
}

std::uint64_t ImageStore::stored_bytes(std::uint32_t width, std::uint32_t height,
                                       std::uint32_t channels) {
  const BlockGrid grid({width, height}, channels);
  std::uint64_t bytes = 0;
  for (std::uint32_t level = 0; level < grid.levels(); ++level)
    bytes += std::uint64_t{grid.size(level).width} * grid.size(level).height * channels;
  return bytes;
}

std::uint64_t ImageStore::adding_bytes(std::uint32_t width, std::uint32_t height,
                                       std::uint32_t channels) {
  return PyramidWriter::bytes({width, height}, channels) + std::uint64_t{width} * channels;
}

}  // namespace meshhier::images
