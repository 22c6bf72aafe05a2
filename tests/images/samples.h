// Pictures and files of all kinds, made by the libraries themselves.
#pragma once

#include "images/image.h"
#include "images/image_codec.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::images {

using Bytes = std::vector<std::byte>;

/// Soft waves with a little noise; every texel of a row differs from its neighbours.
Image waves(std::uint32_t width, std::uint32_t height, std::uint32_t channels = 3);
/// A picture that is like a photograph to a coder: every texel is near its neighbours.
Image smooth(std::uint32_t width, std::uint32_t height, std::uint32_t channels);
/// No texel tells of another.
Image noise(std::uint32_t width, std::uint32_t height, std::uint32_t channels = 3,
            std::uint32_t seed = 1);

struct JpegKind {
  int components = 3;     ///< components that are stored: 1, 3 or 4
  bool separate = false;  ///< colours as they are, without YCC
  bool adobe = false;     ///< with 4 components: Adobe's mark, which says that values are inverted
  int factor = 1;         ///< luma's samples a sample of chroma, in both directions
  bool progressive = false;  ///< many scans
  bool arithmetic = false;
  int restart = 0;  ///< rows of blocks between restart marks
  int quality = 100;
};
/// `image` has 3 channels; of 4 components: black is 0, or full with Adobe's mark.
Bytes jpeg_file(const Image& image, const JpegKind& kind);

struct PngKind {
  /// The format's number: 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGB and alpha.
  int colour = 2;
  int depth = 8;
  bool interlaced = false;
  std::vector<std::uint8_t> palette{};       ///< red, green, blue
  std::vector<std::uint8_t> transparency{};  ///< tRNS as it is in the file
};
/// Rows as they are in the file, packed.
Bytes png_file(std::uint32_t width, std::uint32_t height, const PngKind& kind,
               const std::vector<std::uint8_t>& rows);

/// Lossless if quality is 100.
Bytes webp_file(const Image& image, int quality);

/// Reads no more than `most_at_once` bytes a call.
ByteSource source_of(const Bytes& bytes, std::size_t most_at_once = SIZE_MAX);
Image decoded(const Bytes& bytes);
/// The message of the error, which is of the input; "" if there is none.
std::string refusal(const std::function<void()>& call);

/// The largest difference of two pictures of one size.
int difference(const Image& a, const Image& b);

struct NamedFile {
  std::string name;
  Bytes bytes;
};
/// A small file of each kind that can be read.
std::vector<NamedFile> small_files();

}  // namespace meshhier::images
