#include "images/formats.h"

#include "base/named_value.h"
#include "images/coders.h"
#include "images/ktx2_coder.h"
#include "images/uastc_picture.h"

#include <array>
#include <utility>

namespace meshhier::images {
namespace {

constexpr CoderProcesses kEtc1sProcesses{missing_for_ktx2, ktx2_coder_bytes, end_ktx2_coders};
/// UASTC is coded here.
constexpr bool is_etc1s(int quality) {
  return quality < kBestQuality;
}
constexpr const CoderProcesses* no_processes(int /*quality*/) {
  return nullptr;
}
constexpr std::uint32_t kMostJpegSide = 65500, kMostWebpSide = 16383;
constexpr std::uint64_t kRgba = 4;

/// Larger ones have the standard's codes: all coefficients would wait for the best.
constexpr std::uint64_t kMostHeldJpeg = std::uint64_t{1} << 20;

// Costs of files: with a quality of 90, most of an atlas covered.
constexpr auto kFormats = std::to_array<FormatCoders>({
    {.format = ImageFormat::jpeg,
     .open = open_jpeg,
     .encode = encode_jpeg,
     .encode_directions = encode_normal_jpeg,
     .open_rows =
         [](const WrittenImage& image, ByteSink sink) {
           return open_jpeg_writer(image, JpegCodes::standard, std::move(sink));
         },
     .most_held_texels = kMostHeldJpeg,
     .encoder_bytes = [](std::uint64_t texels, int) { return 6 * texels; },
     .most_side = kMostJpegSide,
     .colours = {0.4, 4, 0},
     .best_colours = {0.4, 4, 0},
     .directions = {0.4, 4, 0},
     .processes = no_processes},
    {.format = ImageFormat::png,
     .open = open_png,
     .encode = [](const Image& image, int) { return encode_png(image); },
     .encode_directions = [](const Image& image, int) { return encode_png(image); },
     .open_rows = open_png_writer,
     .most_held_texels = 0,
     .encoder_bytes = [](std::uint64_t, int) { return std::uint64_t{0}; },
     .most_side = kMaxSourceSide,
     .colours = {1.5, 4, 0},
     .best_colours = {1.5, 4, 0},
     .directions = {1.5, 4, 0},
     .processes = no_processes},
    {.format = ImageFormat::webp,
     .open = open_webp,
     .encode = encode_webp,
     .encode_directions = [](const Image& image, int) { return encode_webp(image, kBestQuality); },
     .open_rows = nullptr,
     .most_held_texels = 0,
     .encoder_bytes =
         [](std::uint64_t texels, int quality) {
           return (is_exact(ImageFormat::webp, quality) ? 21 : 4) * texels;
         },
     .most_side = kMostWebpSide,
     .colours = {0.3, 4, 0},
     .best_colours = {0.3, 4, 0},
     .directions = {1.5, 4, 0},
     .processes = no_processes},
    {.format = ImageFormat::ktx2,
     .open = open_ktx2,
     .encode =
         [](const Image& image, int quality) {
           return is_etc1s(quality) ? encode_etc1s(image, quality)
                                    : encode_uastc(image, Ktx2Meaning::colours);
         },
     .encode_directions = [](const Image& image,
                             int) { return encode_uastc(image, Ktx2Meaning::directions); },
     .open_rows = nullptr,
     .most_held_texels = 0,
     .encoder_bytes =
         [](std::uint64_t texels, int quality) {
           return is_etc1s(quality) ? 2 * kRgba * texels + ktx2_coder_bytes(texels)
                                    : uastc_encoder_bytes(texels);
         },
     .most_side = kMostKtx2Side,
     .colours = {0.4, 0.5, 2500e-9},
     .best_colours = {1.4, 1, 120e-9},
     .directions = {1.5, 1, 300e-9},
     .processes = [](int quality) { return is_etc1s(quality) ? &kEtc1sProcesses : nullptr; }},
});
static_assert(kFormats.size() == kImageFormats.size());
static_assert(are_in_order(kFormats, &FormatCoders::format));

}  // namespace

const FormatCoders& coders_of(ImageFormat format) {
  return kFormats[static_cast<std::size_t>(format)];
}

const TexelCosts& costs_of(const TextureFormat& textures) {
  const FormatCoders& row = coders_of(textures.format);
  return textures.quality == kBestQuality ? row.best_colours : row.colours;
}

const TexelCosts& costs_of(const NormalMapFormat& maps) {
  return coders_of(maps.format).directions;
}

std::string missing_coder(const TextureFormat& textures) {
  const CoderProcesses* const processes = coders_of(textures.format).processes(textures.quality);
  return processes == nullptr ? "" : processes->missing();
}

std::uint64_t coder_bytes(const TextureFormat& textures, std::uint64_t texels) {
  const CoderProcesses* const processes = coders_of(textures.format).processes(textures.quality);
  return processes == nullptr ? 0 : processes->bytes(texels);
}

void end_coders() {
  for (const FormatCoders& row : kFormats) {
    if (const CoderProcesses* const processes = row.processes(1))
      processes->end();
  }
}

}  // namespace meshhier::images
