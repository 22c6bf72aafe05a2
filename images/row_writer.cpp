#include "images/row_writer.h"

#include "images/formats.h"

#include <cassert>
#include <utility>

namespace meshhier::images {

std::unique_ptr<RowWriter> open_row_writer(const WrittenImage& image, ByteSink sink) {
  assert(image.format != ImageFormat::webp);
  return image.format == ImageFormat::png
             ? open_png_writer(image, std::move(sink))
             : open_jpeg_writer(image, JpegCodes::standard, std::move(sink));
}

}  // namespace meshhier::images
