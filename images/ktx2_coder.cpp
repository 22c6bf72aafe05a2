#include "images/ktx2_coder.h"

#include "base/error.h"
#include "storage/io/child_process.h"
#include "storage/io/code_memory.h"
#include "storage/io/own_program.h"
#include "storage/io/worker_pool.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>
#include <utility>

namespace meshhier::images {
namespace {

// The numbers are those of coder.mjs.
constexpr std::uint32_t kProtocol = 2;
constexpr std::uint32_t kEncode = 0, kDecode = 1;
using Request = std::array<std::uint32_t, 5>;  ///< kind, width, height, quality, bytes

constexpr const char* kPlaceVariable = "MESHHIER_KTX2";
constexpr std::array kPlaces{"../share/meshhier/ktx2", "../../images/ktx2"};
constexpr const char* kScript = "coder.mjs";
constexpr const char* kLibrary = "node_modules/ktx2-encoder/dist/basis/basis_encoder.js";

struct Coding {
  std::vector<std::string> words;
  std::string missing;  ///< if not empty, there are no words
};

Coding find_coding() {
  const std::string why = "pictures in KTX2 as ETC1S are coded by Node.js 18 or later";
  const std::optional<std::string> node = storage::find_program("node");
  if (!node) {
    return {{},
            why +
                ", which is not in PATH: \"apt install nodejs npm\"; then "
                "\"meshhier build\" says what else is missing"};
  }
  const storage::CompanionFolder folder(kPlaceVariable, kPlaces, kScript);
  const std::string place = folder.path().string();
  if (!folder.has(kScript)) {
    return {{},
            why + " with coder.mjs of meshhier, which is not in " + place +
                ": name its folder in " + kPlaceVariable};
  }
  if (!folder.has(kLibrary)) {
    return {{},
            why + " and ktx2-encoder, which is not there: \"npm ci --prefix " + place +
                "\" installs it"};
  }
  if (!storage::may_make_code()) {
    return {{},
            why +
                ", which may not run here, as memory may not become executable: in a service of "
                "systemd MemoryDenyWriteExecute=no allows it"};
  }
  return {{*node, (folder.path() / kScript).string()}, {}};
}

std::vector<std::string> coder_words() {
  Coding coding = find_coding();
  if (!coding.missing.empty())
    throw Error(ErrorCode::io, coding.missing);
  return std::move(coding.words);
}

storage::WorkerPool& coders() {
  static storage::WorkerPool pool("the program that codes KTX2", kProtocol, coder_words);
  return pool;
}

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns texels as red, green, blue, alpha.
std::vector<std::byte> with_alpha(const Image& image) {
  const std::size_t texels = std::size_t{image.width} * image.height;
  std::vector<std::byte> all(4 * texels, std::byte{255});
  for (std::size_t i = 0; i < texels; ++i) {
    for (std::size_t k = 0; k < image.channels; ++k)
      all[4 * i + k] = std::byte{image.texels[i * image.channels + k]};
  }
  return all;
}

}  // namespace

std::string missing_for_ktx2() {
  return find_coding().missing;
}

std::vector<std::byte> encode_etc1s(const Image& image, int quality) {
  assert(image.width % 4 == 0 && image.height % 4 == 0);
  assert(std::max(image.width, image.height) <= kMostKtx2Side);
  const std::vector<std::byte> texels = with_alpha(image);
  const Request request{kEncode, image.width, image.height, static_cast<std::uint32_t>(quality),
                        static_cast<std::uint32_t>(texels.size())};
  std::optional<storage::WorkerPool::Answer> result = coders().ask(request, texels);
  if (!result) {
    throw Error(ErrorCode::io,
                "the programs that code KTX2 are ended while they have a picture: if memory is "
                "short, fewer \"threads\" need less");
  }
  if (!result->is_good)
    throw Error(ErrorCode::internal, "ktx2-encoder: " + text_of(result->bytes));
  return std::move(result->bytes);
}

Image decode_ktx2(std::span<const std::byte> file, const Image& shape, const std::string& name) {
  const Request request{kDecode, shape.width, shape.height, 0,
                        static_cast<std::uint32_t>(file.size())};
  const std::optional<storage::WorkerPool::Answer> result = coders().ask(request, file);
  if (!result || !result->is_good) {
    throw Error(ErrorCode::input,
                name + ": the picture is broken: " +
                    (result ? text_of(result->bytes) : "no program that decodes it survives it"));
  }
  Image image(shape.width, shape.height, shape.channels);
  const std::size_t texels = std::size_t{image.width} * image.height;
  if (result->bytes.size() != 4 * texels)
    throw Error(ErrorCode::internal, "ktx2-encoder gave another picture than it was asked for");
  for (std::size_t i = 0; i < texels; ++i) {
    for (std::size_t k = 0; k < image.channels; ++k)
      image.texels[i * image.channels + k] =
          std::to_integer<std::uint8_t>(result->bytes[4 * i + k]);
  }
  return image;
}

std::uint64_t ktx2_coder_bytes(std::uint64_t texels) {
  // Measured for pictures of 64^2 to 3072^2 texels: the more there are, the less one takes.
  constexpr std::uint64_t kProcess = std::uint64_t{128} << 20;
  constexpr std::uint64_t kFew = std::uint64_t{1} << 18, kSome = std::uint64_t{3} << 18;
  constexpr std::uint64_t kOfFew = 1000, kOfSome = 250, kOfMany = 60;
  const std::uint64_t few = std::min(texels, kFew), some = std::min(texels, kSome);
  return kProcess + few * kOfFew + (some - few) * kOfSome + (texels - some) * kOfMany;
}

void end_ktx2_coders() {
  coders().end_idle();
}

}  // namespace meshhier::images
