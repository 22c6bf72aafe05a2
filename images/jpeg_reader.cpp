#include "base/error.h"
#include "images/coders.h"
#include "images/library_call.h"
#include "images/source_buffer.h"

#include <array>
#include <cassert>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <jerror.h>
#include <jpeglib.h>

namespace meshhier::images {
namespace {

/// More scans than any encoder makes, as each may cost a pass over the whole picture.
constexpr int kMostScans = 100;

/// Rows of samples that the library holds: of blocks, of their neighbours, of what it enlarges.
constexpr std::uint64_t kRowsHeld = 64;

class JpegReader final : public ImageReader {
 public:
  JpegReader(ByteSource source, const std::string& name)
      : call_(ErrorCode::input, name), input_(std::move(source)) {}
  ~JpegReader() override { jpeg_destroy_decompress(&jpeg_); }

  void read_head();
  const ImageInfo& info() const override { return info_; }
  void read_rows(std::uint8_t* rows, std::uint32_t count) override;

 private:
  static JpegReader& of(j_common_ptr jpeg) { return *static_cast<JpegReader*>(jpeg->client_data); }
  static JpegReader& of(j_decompress_ptr jpeg) {
    return *static_cast<JpegReader*>(jpeg->client_data);
  }
  void set_callbacks();
  void choose_output();
  std::uint64_t coefficient_bytes() const;
  bool has_ink() const { return jpeg_.out_color_space == JCS_CMYK; }
  void start();
  void read_row(std::uint8_t* row);
  void ink_to_light(std::uint8_t* row) const;

  boolean refill();
  void skip(std::uint64_t bytes);
  void warn();
  [[noreturn]] void fail_with_message();

  LibraryCall call_;
  SourceBuffer input_;
  ImageInfo info_;
  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
  jpeg_source_mgr source_{};
  jpeg_progress_mgr progress_{};
  std::vector<std::uint8_t> ink_;  ///< a row of cyan, magenta, yellow, black
  bool started_ = false;
};

// ---- what the library calls ---------------------------------------------------------------------

void JpegReader::set_callbacks() {
  jpeg_.err = jpeg_std_error(&errors_);
  jpeg_.client_data = this;
  errors_.error_exit = [](j_common_ptr jpeg) { of(jpeg).fail_with_message(); };
  errors_.emit_message = [](j_common_ptr jpeg, int level) {
    if (level < 0)
      of(jpeg).warn();
  };
  errors_.output_message = [](j_common_ptr) {};
  source_.init_source = [](j_decompress_ptr) {};
  source_.fill_input_buffer = [](j_decompress_ptr jpeg) { return of(jpeg).refill(); };
  source_.skip_input_data = [](j_decompress_ptr jpeg, long bytes) {
    if (bytes > 0)
      of(jpeg).skip(static_cast<std::uint64_t>(bytes));
  };
  source_.resync_to_restart = jpeg_resync_to_restart;
  source_.term_source = [](j_decompress_ptr) {};
  progress_.progress_monitor = [](j_common_ptr jpeg) {
    JpegReader& reader = of(jpeg);
    if (reader.jpeg_.input_scan_number > kMostScans)
      reader.call_.fail("the picture has too many scans");
  };
}

boolean JpegReader::refill() {
  std::span<const std::byte> bytes;
  call_.callback([&] { bytes = input_.next(); });
  if (bytes.empty())
    call_.fail(kEndsEarly);
  source_.next_input_byte = reinterpret_cast<const JOCTET*>(bytes.data());
  source_.bytes_in_buffer = bytes.size();
  return TRUE;
}

void JpegReader::skip(std::uint64_t bytes) {
  const std::uint64_t here = std::min<std::uint64_t>(bytes, source_.bytes_in_buffer);
  source_.next_input_byte += here;
  source_.bytes_in_buffer -= here;
  input_.skip(bytes - here);
}

/// Fails at missing or broken data, where the library would go on with grey. Warnings that leave
/// the texels as they are are passed over.
void JpegReader::warn() {
  switch (errors_.msg_code) {
    case JWRN_ADOBE_XFORM:
    case JWRN_BOGUS_ICC:
    case JWRN_JFIF_MAJOR:
    case JWRN_NOT_SEQUENTIAL:
      return;
    case JWRN_EXTRANEOUS_DATA:
      if (errors_.msg_parm.i[1] == JPEG_EOI)
        return;
      break;
    case JWRN_HIT_MARKER:
    case JWRN_JPEG_EOF:
      call_.fail(kEndsEarly);
    default:
      break;
  }
  fail_with_message();
}

void JpegReader::fail_with_message() {
  std::array<char, JMSG_LENGTH_MAX> message{};
  errors_.format_message(reinterpret_cast<j_common_ptr>(&jpeg_), message.data());
  call_.fail(message.data());
}

// ---- the head -----------------------------------------------------------------------------------

void JpegReader::read_head() {
  set_callbacks();
  call_.run([this] {
    jpeg_create_decompress(&jpeg_);
    jpeg_.mem->max_memory_to_use = 0;  // whatever JPEGMEM says
    jpeg_.src = &source_;
    jpeg_.progress = &progress_;
    jpeg_read_header(&jpeg_, TRUE);
    choose_output();
  });
  const std::uint64_t rows =
      std::uint64_t{jpeg_.image_width} * static_cast<unsigned>(jpeg_.num_components) * kRowsHeld;
  info_ = {.format = ImageFormat::jpeg,
           .width = jpeg_.image_width,
           .height = jpeg_.image_height,
           .channels = 3,
           .decoder_bytes = rows + coefficient_bytes()};
}

/// All that could differ between versions of the library is said.
void JpegReader::choose_output() {
  switch (jpeg_.jpeg_color_space) {
    case JCS_GRAYSCALE:
    case JCS_RGB:
    case JCS_YCbCr:
      jpeg_.out_color_space = JCS_RGB;
      break;
    case JCS_CMYK:
    case JCS_YCCK:
      jpeg_.out_color_space = JCS_CMYK;
      break;
    default:
      call_.fail("the picture is neither grey nor RGB nor CMYK");
  }
  jpeg_.dct_method = JDCT_ISLOW;
  jpeg_.do_fancy_upsampling = TRUE;
  jpeg_.do_block_smoothing = FALSE;
}

/// Returns 0 if rows are decoded one by one.
std::uint64_t JpegReader::coefficient_bytes() const {
  jpeg_decompress_struct& jpeg = const_cast<jpeg_decompress_struct&>(jpeg_);
  if (jpeg_has_multiple_scans(&jpeg) == FALSE)
    return 0;
  const auto padded = [](std::uint64_t blocks, int factor) {
    const auto step = static_cast<std::uint64_t>(factor);
    return (blocks + step - 1) / step * step;
  };
  std::uint64_t bytes = 0;
  for (int i = 0; i < jpeg_.num_components; ++i) {
    const jpeg_component_info& component = jpeg_.comp_info[i];
    bytes += padded(component.width_in_blocks, component.h_samp_factor) *
             padded(component.height_in_blocks, component.v_samp_factor) * sizeof(JBLOCK);
  }
  return bytes;
}

// ---- the rows -----------------------------------------------------------------------------------

void JpegReader::read_rows(std::uint8_t* rows, std::uint32_t count) {
  if (!started_)
    start();
  assert(count <= info_.height - jpeg_.output_scanline);
  call_.run([=, this] {
    for (std::uint32_t i = 0; i < count; ++i)
      read_row(rows + std::size_t{i} * info_.width * 3);
    if (jpeg_.output_scanline == jpeg_.output_height)
      jpeg_finish_decompress(&jpeg_);
  });
}

void JpegReader::start() {
  if (has_ink())
    ink_.resize(std::size_t{4} * info_.width);
  call_.run([this] { jpeg_start_decompress(&jpeg_); });
  started_ = true;
}

void JpegReader::read_row(std::uint8_t* row) {
  JSAMPROW target = has_ink() ? ink_.data() : row;
  jpeg_read_scanlines(&jpeg_, &target, 1);
  if (has_ink())
    ink_to_light(row);
}

/// Light is what cyan and black both leave. Adobe's programs store how much that is; without their
/// mark the values tell the ink.
void JpegReader::ink_to_light(std::uint8_t* row) const {
  const unsigned turn = jpeg_.saw_Adobe_marker == FALSE ? 255 : 0;
  for (std::size_t x = 0; x < info_.width; ++x) {
    const std::uint8_t* ink = ink_.data() + 4 * x;
    for (std::size_t c = 0; c < 3; ++c)
      row[3 * x + c] = static_cast<std::uint8_t>(((ink[c] ^ turn) * (ink[3] ^ turn) + 127) / 255);
  }
}

}  // namespace

std::unique_ptr<ImageReader> open_jpeg(ByteSource source, const std::string& name) {
  auto reader = std::make_unique<JpegReader>(std::move(source), name);
  reader->read_head();
  return reader;
}

}  // namespace meshhier::images
