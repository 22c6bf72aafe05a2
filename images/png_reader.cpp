#include "base/error.h"
#include "images/coders.h"
#include "images/library_call.h"
#include "images/source_buffer.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <png.h>

namespace meshhier::images {
namespace {

/// The memory of the library and zlib: fixed tables and a window; rows of up to 8 bytes a texel.
constexpr std::uint64_t kLibraryBytes = 65536;
constexpr std::uint64_t kBytesPerColumn = 32;

class PngReader final : public ImageReader {
 public:
  PngReader(ByteSource source, const std::string& name)
      : call_(ErrorCode::input, name), input_(std::move(source)) {}
  ~PngReader() override { png_destroy_read_struct(&png_, &head_, nullptr); }

  void read_head();
  const ImageInfo& info() const override { return info_; }
  void read_rows(std::uint8_t* rows, std::uint32_t count) override;

 private:
  void set_limits();
  void set_output();
  bool has_alpha() const;
  std::size_t row_bytes() const { return std::size_t{info_.width} * info_.channels; }
  void copy_bytes(std::uint8_t* into, std::size_t count);
  void read_passes();
  [[noreturn]] void fail(std::string_view message);

  LibraryCall call_;
  SourceBuffer input_;
  std::span<const std::byte> unread_;
  ImageInfo info_;
  png_structp png_ = nullptr;
  png_infop head_ = nullptr;
  int passes_ = 1;                   ///< over the picture; more than 1 if it is interlaced
  std::uint32_t next_row_ = 0;       ///< the next row to be handed out
  std::vector<std::uint8_t> whole_;  ///< all rows of an interlaced picture
  std::string warning_;              ///< the last one
};

void PngReader::read_head() {
  call_.run([this] {
    png_ = png_create_read_struct(
        PNG_LIBPNG_VER_STRING, this,
        [](png_structp png, png_const_charp message) {
          static_cast<PngReader*>(png_get_error_ptr(png))->fail(message);
        },
        [](png_structp png, png_const_charp warning) {
          static_cast<PngReader*>(png_get_error_ptr(png))->warning_ = warning;
        });
    head_ = png_ == nullptr ? nullptr : png_create_info_struct(png_);
    if (head_ == nullptr)
      call_.fail("there is no memory to read the picture");
    png_set_read_fn(png_, this, [](png_structp png, png_bytep into, std::size_t count) {
      static_cast<PngReader*>(png_get_io_ptr(png))->copy_bytes(into, count);
    });
    set_limits();
    png_read_info(png_, head_);
    set_output();
  });
}

/// Fails with a message; the library tells as a warning what is wrong with a head.
void PngReader::fail(std::string_view message) {
  call_.fail(message == "Invalid IHDR data" && !warning_.empty() ? warning_ : message);
}

/// Chunks that change no texel are neither unpacked nor kept, and nothing that is broken is passed
/// over.
void PngReader::set_limits() {
  png_set_user_limits(png_, kMaxSourceSide, kMaxSourceSide);
  png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
}

void PngReader::set_output() {
  png_set_expand(png_);
  png_set_scale_16(png_);
  png_set_gray_to_rgb(png_);
  passes_ = png_set_interlace_handling(png_);
  info_ = {.format = ImageFormat::png,
           .width = png_get_image_width(png_, head_),
           .height = png_get_image_height(png_, head_),
           .channels = has_alpha() ? 4U : 3U,
           .decoder_bytes = 0};
  info_.decoder_bytes = kLibraryBytes + kBytesPerColumn * info_.width;
  if (passes_ > 1)
    info_.decoder_bytes += row_bytes() * info_.height;
  png_read_update_info(png_, head_);
  assert(png_get_rowbytes(png_, head_) == row_bytes());
}

bool PngReader::has_alpha() const {
  return (png_get_color_type(png_, head_) & PNG_COLOR_MASK_ALPHA) != 0 ||
         png_get_valid(png_, head_, PNG_INFO_tRNS) != 0;
}

void PngReader::copy_bytes(std::uint8_t* into, std::size_t count) {
  while (count > 0) {
    if (unread_.empty())
      call_.callback([this] { unread_ = input_.next(); });
    if (unread_.empty())
      call_.fail(kEndsEarly);
    const std::size_t part = std::min(count, unread_.size());
    std::memcpy(into, unread_.data(), part);
    unread_ = unread_.subspan(part);
    into += part;
    count -= part;
  }
}

void PngReader::read_rows(std::uint8_t* rows, std::uint32_t count) {
  assert(count <= info_.height - next_row_);
  if (passes_ > 1 && next_row_ == 0)
    read_passes();
  if (passes_ > 1) {
    std::memcpy(rows, whole_.data() + next_row_ * row_bytes(), count * row_bytes());
  } else {
    call_.run([=, this] {
      for (std::uint32_t i = 0; i < count; ++i)
        png_read_row(png_, rows + i * row_bytes(), nullptr);
    });
  }
  next_row_ += count;
  if (next_row_ == info_.height)
    call_.run([this] { png_read_end(png_, nullptr); });
}

void PngReader::read_passes() {
  whole_.resize(row_bytes() * info_.height);
  call_.run([this] {
    for (int pass = 0; pass < passes_; ++pass) {
      for (std::size_t y = 0; y < info_.height; ++y)
        png_read_row(png_, whole_.data() + y * row_bytes(), nullptr);
    }
  });
}

}  // namespace

std::unique_ptr<ImageReader> open_png(ByteSource source, const std::string& name) {
  auto reader = std::make_unique<PngReader>(std::move(source), name);
  reader->read_head();
  return reader;
}

}  // namespace meshhier::images
