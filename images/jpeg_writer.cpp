#include "base/error.h"
#include "images/coders.h"
#include "images/direction_codes.h"
#include "images/encode_rows.h"
#include "images/library_call.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdio>
#include <span>
#include <utility>
#include <vector>

#include <jpeglib.h>

namespace meshhier::images {
namespace {

/// From here on chroma has as many samples as luma.
constexpr int kFullChromaQuality = 90;
/// The quality of a direction's blue, which follows from red and green but for its sign.
constexpr int kBlueQuality = 30;
/// Between these kDirectionCodes fit; at 50 files of smooth maps would be a tenth larger.
constexpr int kLeastFittedQuality = 75, kMostFittedQuality = 95;

class JpegWriter final : public RowWriter {
 public:
  JpegWriter(const WrittenImage& image, JpegCodes codes, ByteSink sink, JpegContent content);
  ~JpegWriter() override { jpeg_destroy_compress(&jpeg_); }
  JpegWriter(const JpegWriter&) = delete;
  JpegWriter& operator=(const JpegWriter&) = delete;

  void write_row(const std::uint8_t* row) override;
  void finish() override {
    call_.run([&] { jpeg_finish_compress(&jpeg_); });
  }

 private:
  template <class Jpeg>
  static JpegWriter& of(Jpeg jpeg) {
    return *static_cast<JpegWriter*>(jpeg->client_data);
  }
  void set_callbacks();
  void set_parameters(const WrittenImage& image, JpegCodes codes, JpegContent content);
  void keep_directions(int quality);
  void put_direction_codes();
  void empty_buffer();
  void send_buffer(std::size_t bytes);

  LibraryCall call_;
  ByteSink sink_;
  jpeg_compress_struct jpeg_{};
  jpeg_error_mgr errors_{};
  jpeg_destination_mgr destination_{};
  std::array<std::byte, 65536> buffer_{};
};

JpegWriter::JpegWriter(const WrittenImage& image, JpegCodes codes, ByteSink sink,
                       JpegContent content)
    : call_(ErrorCode::internal, "libjpeg"), sink_(std::move(sink)) {
  assert(image.channels == 3);
  set_callbacks();
  try {
    call_.run([&] {
      jpeg_create_compress(&jpeg_);
      jpeg_.mem->max_memory_to_use = 0;  // whatever JPEGMEM says
      jpeg_.dest = &destination_;
      set_parameters(image, codes, content);
      jpeg_start_compress(&jpeg_, TRUE);
    });
  } catch (...) {
    jpeg_destroy_compress(&jpeg_);
    throw;
  }
}

void JpegWriter::set_callbacks() {
  jpeg_.err = jpeg_std_error(&errors_);
  jpeg_.client_data = this;
  errors_.error_exit = [](j_common_ptr jpeg) {
    std::array<char, JMSG_LENGTH_MAX> message{};
    jpeg->err->format_message(jpeg, message.data());
    of(jpeg).call_.fail(message.data());
  };
  errors_.output_message = [](j_common_ptr) {};
  destination_.init_destination = [](j_compress_ptr jpeg) { of(jpeg).empty_buffer(); };
  destination_.empty_output_buffer = [](j_compress_ptr jpeg) -> boolean {
    of(jpeg).send_buffer(sizeof(buffer_));
    return TRUE;
  };
  destination_.term_destination = [](j_compress_ptr jpeg) {
    of(jpeg).send_buffer(sizeof(buffer_) - jpeg->dest->free_in_buffer);
  };
}

void JpegWriter::empty_buffer() {
  destination_.next_output_byte = reinterpret_cast<JOCTET*>(buffer_.data());
  destination_.free_in_buffer = buffer_.size();
}

void JpegWriter::send_buffer(std::size_t bytes) {
  call_.callback([&] { sink_(std::span(buffer_).first(bytes)); });
  empty_buffer();
}

void JpegWriter::set_parameters(const WrittenImage& image, JpegCodes codes, JpegContent content) {
  jpeg_.image_width = image.width;
  jpeg_.image_height = image.height;
  jpeg_.input_components = 3;
  jpeg_.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg_);
  jpeg_set_quality(&jpeg_, image.quality, TRUE);
  jpeg_.dct_method = JDCT_ISLOW;
  jpeg_.optimize_coding = codes == JpegCodes::best ? TRUE : FALSE;
  jpeg_.comp_info[0].h_samp_factor = image.quality < kFullChromaQuality ? 2 : 1;
  jpeg_.comp_info[0].v_samp_factor = jpeg_.comp_info[0].h_samp_factor;
  if (content == JpegContent::directions)
    keep_directions(image.quality);
  if (codes == JpegCodes::of_directions)
    put_direction_codes();
}

/// Keeps red, green and blue as they are (the Adobe marker says so), by the table of luminance.
void JpegWriter::keep_directions(int quality) {
  jpeg_set_colorspace(&jpeg_, JCS_RGB);
  jpeg_set_quality(&jpeg_, std::min(quality, kBlueQuality), TRUE);
  std::array<unsigned, DCTSIZE2> coarse{};
  std::ranges::copy(jpeg_.quant_tbl_ptrs[0]->quantval, coarse.begin());
  jpeg_set_quality(&jpeg_, quality, TRUE);
  jpeg_add_quant_table(&jpeg_, 1, coarse.data(), 100, TRUE);
  jpeg_component_info& blue = jpeg_.comp_info[2];
  blue.quant_tbl_no = blue.dc_tbl_no = blue.ac_tbl_no = 1;
  for (int i = 0; i < 3; ++i)
    jpeg_.comp_info[i].h_samp_factor = jpeg_.comp_info[i].v_samp_factor = 1;
}

void JpegWriter::put_direction_codes() {
  const auto put = [](const auto& code, JHUFF_TBL& table) {
    std::ranges::copy(code.counts, table.bits + 1);
    std::ranges::copy(code.symbols, table.huffval);
    table.sent_table = FALSE;
  };
  for (std::size_t i = 0; i < kDirectionCodes.size(); ++i) {
    put(kDirectionCodes[i].steady, *jpeg_.dc_huff_tbl_ptrs[i]);
    put(kDirectionCodes[i].changes, *jpeg_.ac_huff_tbl_ptrs[i]);
  }
}

void JpegWriter::write_row(const std::uint8_t* row) {
  auto* read_only = const_cast<JSAMPROW>(row);
  call_.run([&] { jpeg_write_scanlines(&jpeg_, &read_only, 1); });
}

}  // namespace

std::unique_ptr<RowWriter> open_jpeg_writer(const WrittenImage& image, JpegCodes codes,
                                            ByteSink sink, JpegContent content) {
  return std::make_unique<JpegWriter>(image, codes, std::move(sink), content);
}

std::vector<std::byte> encode_jpeg(const Image& image, int quality) {
  return encode_rows(image, [&](ByteSink sink) {
    return open_jpeg_writer({ImageFormat::jpeg, quality, image.width, image.height, image.channels},
                            JpegCodes::best, std::move(sink));
  });
}

std::vector<std::byte> encode_normal_jpeg(const Image& image, int quality) {
  const bool fits = quality >= kLeastFittedQuality && quality <= kMostFittedQuality;
  const JpegCodes codes = fits ? JpegCodes::of_directions : JpegCodes::best;
  return encode_rows(image, [&](ByteSink sink) {
    return open_jpeg_writer({ImageFormat::jpeg, quality, image.width, image.height, image.channels},
                            codes, std::move(sink), JpegContent::directions);
  });
}

}  // namespace meshhier::images
