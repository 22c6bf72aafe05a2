// The input is a file with a picture. One that is read is read alike row by row from a source that
// gives little at a time, and comes back from a PNG file of our own.
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "images/image_codec.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace meshhier::tests::fuzz {
namespace {

using images::Image;
using images::ImageInfo;

constexpr std::uint64_t kMostTexels = 1 << 16;
constexpr std::size_t kLittle = 7;
const std::string kName = "picture";

/// Says whether it is KTX2 of any kind but UASTC.
bool is_of_another_program(Bytes input) {
  constexpr std::string_view kKtx2 = "\xabKTX 20";
  constexpr std::size_t kDescriptionAt = 48, kModelAt = 12;
  constexpr auto kUastc = std::byte{166};
  if (!std::ranges::equal(input.first(std::min(input.size(), kKtx2.size())),
                          std::as_bytes(std::span(kKtx2))))
    return false;
  if (input.size() < kDescriptionAt + sizeof(std::uint32_t))
    return true;
  const std::size_t model =
      std::size_t{storage::load_little<std::uint32_t>(input.data() + kDescriptionAt)} + kModelAt;
  return model >= input.size() || input[model] != kUastc;
}

images::ByteSource source_of(Bytes input) {
  return [input](std::uint64_t offset, std::span<std::byte> into) {
    const Bytes rest = input.subspan(std::min<std::uint64_t>(offset, input.size()));
    const std::size_t count = std::min({rest.size(), into.size(), kLittle});
    std::copy_n(rest.begin(), count, into.begin());
    return count;
  };
}

Image read_by_rows(Bytes input) {
  const std::unique_ptr<images::ImageReader> reader = images::open_image(source_of(input), kName);
  const ImageInfo info = reader->info();
  require(info.channels == 3 || info.channels == 4, "a picture has 3 or 4 channels");
  Image image(info.width, info.height, info.channels);
  for (std::uint32_t y = 0; y < image.height; ++y)
    reader->read_rows(image.at(0, y), 1);
  return image;
}

}  // namespace

void image(Bytes input) {
  // Their heads are read here.
  if (is_of_another_program(input)) {
    refusal({ErrorCode::input}, kName, [&] { images::open_image(source_of(input), kName); });
    return;
  }
  Image whole;
  const std::string message = refusal(
      {ErrorCode::input}, kName, [&] { whole = images::decode_image(input, kName, kMostTexels); });
  if (!message.empty())
    return;
  require(read_by_rows(input) == whole, "a picture is the same row by row");
  if (std::max(whole.width, whole.height) > kMaxImageSide)
    return;
  const auto png = images::encode_image(whole, ImageFormat::png, 100);
  require(images::decode_image(png, kName, kMostTexels) == whole, "PNG is exact");
}

}  // namespace meshhier::tests::fuzz
