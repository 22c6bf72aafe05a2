// The functions that read and write one format each, which the rows of formats.cpp name. Their
// contracts are those of open_image(), open_row_writer(), encode_image() and encode_normal_map().
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

/// Huffman codes: the standard's, those that fit directions, or the best ones for a picture. These
/// are known after its last row: all of its coefficients wait for them.
enum class JpegCodes { standard, of_directions, best };
/// The meaning of three channels: colours, whose hues are seen with less detail, or directions.
enum class JpegContent { colours, directions };
std::unique_ptr<RowWriter> open_jpeg_writer(const WrittenImage& image, JpegCodes codes,
                                            ByteSink sink,
                                            JpegContent content = JpegContent::colours);
std::unique_ptr<RowWriter> open_png_writer(const WrittenImage& image, ByteSink sink);

std::vector<std::byte> encode_jpeg(const Image& image, int quality);
std::vector<std::byte> encode_normal_jpeg(const Image& image, int quality);
std::vector<std::byte> encode_png(const Image& image);
std::vector<std::byte> encode_webp(const Image& image, int quality);

}  // namespace meshhier::images
