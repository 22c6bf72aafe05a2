// What reads and writes one format each: the functions that formats.cpp names.
#pragma once

#include "images/image.h"
#include "images/image_codec.h"
#include "images/row_writer.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::images {

std::unique_ptr<ImageReader> open_jpeg(ByteSource source, const std::string& name);
std::unique_ptr<ImageReader> open_png(ByteSource source, const std::string& name);
std::unique_ptr<ImageReader> open_webp(ByteSource source, const std::string& name);
std::unique_ptr<ImageReader> open_ktx2(ByteSource source, const std::string& name);

/// The best codes for a picture are known after its last row: all of its coefficients wait for
/// them.
enum class JpegCodes { standard, best };
/// What three channels are: light of a screen, seen with less detail in its hues, or directions.
enum class JpegContent { colours, directions };
std::unique_ptr<RowWriter> open_jpeg_writer(const WrittenImage& image, JpegCodes codes,
                                            ByteSink sink,
                                            JpegContent content = JpegContent::colours);
std::unique_ptr<RowWriter> open_png_writer(const WrittenImage& image, ByteSink sink);

std::vector<std::byte> encode_jpeg(const Image& image, int quality);
/// As encode_normal_map().
std::vector<std::byte> encode_normal_jpeg(const Image& image, int quality);
std::vector<std::byte> encode_png(const Image& image);
std::vector<std::byte> encode_webp(const Image& image, int quality);

}  // namespace meshhier::images
