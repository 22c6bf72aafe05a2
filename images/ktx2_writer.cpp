#include "images/ktx2_writer.h"

#include "base/error.h"
#include "hierarchy/image_format.h"
#include "images/ktx2_format.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>

#include <zstd.h>

namespace meshhier::images {
namespace {

/// As that of other encoders; 9 packs a hundredth more in twice the time.
constexpr int kPackingLevel = 6;

constexpr std::string_view kWriterKey = "KTXwriter", kWriter = "meshhier";

struct EndOfPacking {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};
using Packing = std::unique_ptr<ZSTD_CCtx, EndOfPacking>;

std::size_t require_good(std::size_t result) {
  if (ZSTD_isError(result) != 0)
    throw Error(ErrorCode::internal, std::string("libzstd: ") + ZSTD_getErrorName(result));
  return result;
}

void append(std::vector<std::byte>& file, std::span<const std::byte> bytes) {
  file.insert(file.end(), bytes.begin(), bytes.end());
}

void append(std::vector<std::byte>& file, std::string_view text) {
  append(file, std::as_bytes(std::span(text)));
}

std::vector<std::byte> packed(ZSTD_CCtx& context, std::span<const UastcBytes> blocks) {
  const auto bytes = std::as_bytes(blocks);
  std::vector<std::byte> made(ZSTD_compressBound(bytes.size()));
  made.resize(require_good(ZSTD_compressCCtx(&context, made.data(), made.size(), bytes.data(),
                                             bytes.size(), kPackingLevel)));
  return made;
}

/// Bytes of a Khronos Data Format description: 16 bytes a block, one sample of all channels.
std::vector<std::byte> description_of(const Ktx2Picture& picture) {
  constexpr std::uint32_t kVersion = 2, kBt709 = 1, kLinear = 1, kSrgb = 2;
  constexpr std::uint32_t kLastTexel = kBlockSide - 1, kLastBit = 127;
  const std::uint32_t transfer = picture.meaning == Ktx2Meaning::colours ? kSrgb : kLinear;
  const std::uint32_t channel = picture.has_alpha ? ktx2::kUastcRgba : ktx2::kUastcRgb;
  const std::array<std::uint32_t, 11> words{ktx2::kDescriptionBytes,
                                            0,  // the basic descriptor of Khronos
                                            kVersion | (ktx2::kDescriptionBytes - 4) << 16,
                                            ktx2::kUastc | kBt709 << 8 | transfer << 16,
                                            kLastTexel | kLastTexel << 8,
                                            kUastcBlockBytes,
                                            0,
                                            kLastBit << 16 | channel << 24,
                                            0,
                                            0,
                                            0xffffffff};
  std::vector<std::byte> bytes(sizeof words);
  storage::store_all_little<std::uint32_t>(words, bytes.data());
  return bytes;
}

std::vector<std::byte> keys_and_values() {
  std::vector<std::byte> bytes;
  storage::append_little(bytes, static_cast<std::uint32_t>(kWriterKey.size() + kWriter.size() + 2));
  append(bytes, kWriterKey);
  bytes.emplace_back();
  append(bytes, kWriter);
  bytes.emplace_back();
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes;
}

std::vector<std::byte> head_of(const Ktx2Picture& picture, std::uint32_t levels,
                               std::uint32_t description_bytes, std::uint32_t keys_bytes) {
  std::vector<std::byte> head(ktx2::kHeadBytes);
  const std::string_view mark = row_of(ImageFormat::ktx2).file.marks[0].bytes;
  std::ranges::copy(std::as_bytes(std::span(mark)), head.begin());
  const auto put = [&](std::size_t at, std::size_t value) {
    storage::store_little(static_cast<std::uint32_t>(value), head.data() + at);
  };
  const std::size_t description = ktx2::kHeadBytes + levels * ktx2::kLevelBytes;
  put(ktx2::kTypeSizeAt, 1);
  put(ktx2::kWidthAt, picture.size.width);
  put(ktx2::kHeightAt, picture.size.height);
  put(ktx2::kFacesAt, 1);
  put(ktx2::kLevelsAt, levels);
  put(ktx2::kSchemeAt, ktx2::kZstandard);
  put(ktx2::kDescriptionAt, description);
  put(ktx2::kDescriptionBytesAt, description_bytes);
  put(ktx2::kKeysAt, description + description_bytes);
  put(ktx2::kKeysBytesAt, keys_bytes);
  return head;
}

}  // namespace

std::vector<std::byte> ktx2_file(const Ktx2Picture& picture,
                                 std::span<const std::vector<UastcBytes>> levels) {
  const Packing context(ZSTD_createCCtx());
  if (context == nullptr)
    throw Error(ErrorCode::internal, "libzstd has no memory");
  const std::vector<std::byte> description = description_of(picture), keys = keys_and_values();
  std::vector<std::byte> file = head_of(picture, static_cast<std::uint32_t>(levels.size()),
                                        static_cast<std::uint32_t>(description.size()),
                                        static_cast<std::uint32_t>(keys.size()));
  file.resize(file.size() + levels.size() * ktx2::kLevelBytes);
  append(file, description);
  append(file, keys);
  for (std::size_t i = levels.size(); i-- > 0;) {
    const std::vector<std::byte> level = packed(*context, levels[i]);
    std::byte* const entry = file.data() + ktx2::kHeadBytes + i * ktx2::kLevelBytes;
    storage::store_little(std::uint64_t{file.size()}, entry);
    storage::store_little(std::uint64_t{level.size()}, entry + 8);
    storage::store_little(std::uint64_t{levels[i].size() * kUastcBlockBytes}, entry + 16);
    append(file, level);
  }
  return file;
}

std::uint64_t ktx2_packing_bytes(std::uint64_t texels) {
  // The library's tables, and the level that it packs, twice: in its buffer and in the file.
  constexpr std::uint64_t kTables = std::uint64_t{4} << 20;
  return kTables + 3 * texels;
}

}  // namespace meshhier::images
