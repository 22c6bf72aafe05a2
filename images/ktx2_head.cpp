#include "images/ktx2_head.h"

#include "base/error.h"
#include "hierarchy/texture.h"
#include "images/source_buffer.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <span>

namespace meshhier::images {
namespace {

constexpr std::uint32_t kMostLevels = 16, kMostDescription = 1024;
/// No coder makes more of a picture with all smaller ones.
constexpr std::uint64_t kMostKtx2BytesPerTexel = 4;
constexpr std::uint64_t kMostSlack = std::uint64_t{1} << 20;

std::uint32_t u32(std::span<const std::byte> bytes, std::size_t at) {
  return storage::load_little<std::uint32_t>(bytes.data() + at);
}

std::uint64_t u64(std::span<const std::byte> bytes, std::size_t at) {
  return storage::load_little<std::uint64_t>(bytes.data() + at);
}

class HeadReader {
 public:
  HeadReader(const ByteSource& source, const std::string& name) : source_(source), name_(name) {}

  Ktx2Head operator()() {
    std::array<std::byte, ktx2::kHeadBytes> bytes{};
    read_all(0, bytes);
    read_size(bytes);
    read_description(bytes);
    read_levels(bytes);
    return std::move(head_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw Error(ErrorCode::input, name_ + ": " + message);
  }
  void read_all(std::uint64_t offset, std::span<std::byte> into) const {
    if (read_at(source_, offset, into) < into.size())
      fail(std::string(kEndsEarly));
  }
  void read_size(std::span<const std::byte> bytes);
  void read_description(std::span<const std::byte> bytes);
  void read_levels(std::span<const std::byte> bytes);

  const ByteSource& source_;
  const std::string& name_;
  Ktx2Head head_;
};

void HeadReader::read_size(std::span<const std::byte> bytes) {
  if (u32(bytes, ktx2::kVkFormatAt) != 0 || u32(bytes, ktx2::kDepthAt) != 0 ||
      u32(bytes, ktx2::kLayersAt) > 1 || u32(bytes, ktx2::kFacesAt) != 1 ||
      u32(bytes, ktx2::kLevelsAt) == 0 || u32(bytes, ktx2::kLevelsAt) > kMostLevels)
    fail("of KTX2, single pictures of Basis Universal (ETC1S, UASTC) are read");
  head_.width = u32(bytes, ktx2::kWidthAt);
  head_.height = u32(bytes, ktx2::kHeightAt);
  if (head_.width == 0 || head_.height == 0 || std::max(head_.width, head_.height) > kMaxImageSide)
    fail("the picture is broken: a side has no texels, or more than " +
         std::to_string(kMaxImageSide));
}

void HeadReader::read_description(std::span<const std::byte> bytes) {
  const std::uint32_t count = u32(bytes, ktx2::kDescriptionBytesAt);
  if (count < ktx2::kDescriptionBytes || count > kMostDescription)
    fail("the picture is broken: its description has an impossible size");
  std::vector<std::byte> description(count);
  read_all(u32(bytes, ktx2::kDescriptionAt), description);
  const auto model = std::to_integer<std::uint32_t>(description[ktx2::kModelAt]);
  head_.scheme = u32(bytes, ktx2::kSchemeAt);
  if (model == ktx2::kEtc1s && head_.scheme == ktx2::kBasisLz) {
    head_.model = ktx2::kEtc1s;
    head_.channels = count >= ktx2::kDescriptionBytes + ktx2::kSampleBytes ? 4 : 3;
  } else if (model == ktx2::kUastc &&
             (head_.scheme == ktx2::kPlain || head_.scheme == ktx2::kZstandard)) {
    const auto channel =
        std::to_integer<std::uint32_t>(description[ktx2::kSampleAt + ktx2::kChannelAt]);
    head_.channels = (channel & ktx2::kChannelBits) == ktx2::kUastcRgba ? 4 : 3;
  } else {
    fail("of KTX2, pictures of Basis Universal (ETC1S, UASTC) are read");
  }
}

void HeadReader::read_levels(std::span<const std::byte> bytes) {
  const std::uint64_t most =
      std::uint64_t{head_.width} * head_.height * kMostKtx2BytesPerTexel + kMostSlack;
  std::vector<std::byte> levels(std::size_t{u32(bytes, ktx2::kLevelsAt)} * ktx2::kLevelBytes);
  read_all(ktx2::kHeadBytes, levels);
  head_.file_bytes = ktx2::kHeadBytes + levels.size();
  const auto add = [&](std::uint64_t offset, std::uint64_t count) {
    if (offset > most || count > most - offset)
      fail("the picture is broken: it says that it is larger than any picture of its size");
    head_.file_bytes = std::max(head_.file_bytes, offset + count);
  };
  for (std::size_t at = 0; at < levels.size(); at += ktx2::kLevelBytes) {
    head_.levels.push_back({u64(levels, at), u64(levels, at + 8), u64(levels, at + 16)});
    add(head_.levels.back().offset, head_.levels.back().bytes);
  }
  add(u64(bytes, ktx2::kGlobalDataAt), u64(bytes, ktx2::kGlobalDataAt + 8));
  add(u32(bytes, ktx2::kKeysAt), u32(bytes, ktx2::kKeysBytesAt));
}

}  // namespace

Ktx2Head read_ktx2_head(const ByteSource& source, const std::string& name) {
  return HeadReader(source, name)();
}

}  // namespace meshhier::images
