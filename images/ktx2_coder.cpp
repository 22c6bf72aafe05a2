#include "images/ktx2_coder.h"

#include "hierarchy/error.h"
#include "storage/io/child_process.h"
#include "storage/io/own_program.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

namespace meshhier::images {
namespace {

namespace fs = std::filesystem;

// As coder.mjs has them.
constexpr std::uint32_t kProtocol = 1;
constexpr std::uint32_t kDecode = 3;
using Request = std::array<std::uint32_t, 5>;  ///< kind, width, height, quality, bytes
using Answer = std::array<std::uint32_t, 2>;   ///< status, bytes

constexpr const char* kPlaceVariable = "MESHHIER_KTX2";
constexpr std::array kPlaces{"../share/meshhier/ktx2", "../../images/ktx2"};
constexpr const char* kScript = "coder.mjs";
constexpr const char* kLibrary = "node_modules/ktx2-encoder/dist/basis/basis_encoder.js";

/// Where the script lies: as the user says, installed, or in the source tree.
fs::path coder_directory() {
  if (const char* const given = std::getenv(kPlaceVariable); given != nullptr && *given != '\0')
    return given;
  const fs::path program = storage::own_directory();
  fs::path directory;
  for (const char* const place : kPlaces) {
    directory = (program / place).lexically_normal();
    std::error_code error;
    if (fs::exists(directory / kScript, error))
      break;
  }
  return directory;
}

struct Coding {
  std::string node, script;
  std::string missing;  ///< if not empty, the others may be
};

Coding find_coding() {
  constexpr const char* kWhy = "pictures in KTX2 are coded by Node.js 18 or later";
  const std::optional<std::string> node = storage::find_program("node");
  if (!node)
    return {{},
            {},
            std::string(kWhy) +
                ", which is not in PATH: \"apt install nodejs npm\"; then "
                "\"meshhier build\" says what else is missing"};
  const fs::path directory = coder_directory();
  std::error_code error;
  if (!fs::exists(directory / kScript, error))
    return {{},
            {},
            std::string(kWhy) + " with coder.mjs of meshhier, which is not in " +
                directory.string() + ": name its folder in " + kPlaceVariable};
  if (!fs::exists(directory / kLibrary, error))
    return {{},
            {},
            std::string(kWhy) + " and ktx2-encoder, which is not there: \"npm ci --prefix " +
                directory.string() + "\" installs it"};
  return {*node, (directory / kScript).string(), {}};
}

/// A process that codes.
class Coder {
 public:
  explicit Coder(const Coding& coding)
      : words_(coding.node + " " + coding.script),
        process_({coding.node, coding.script}, storage::ChildProcess::Errors::dropped,
                 storage::ChildProcess::Speech::socket) {}

  /// It says so itself once it is ready.
  bool is_ready() {
    std::uint32_t protocol = 0;
    return process_.receive(std::as_writable_bytes(std::span(&protocol, 1))) &&
           protocol == kProtocol;
  }

  struct Result {
    bool is_good = false;
    std::vector<std::byte> bytes;  ///< else why not
  };
  /// Nothing if the process has ended.
  std::optional<Result> ask(const Request& request, std::span<const std::byte> bytes) {
    Answer answer{};
    if (!process_.send(std::as_bytes(std::span(request))) || !process_.send(bytes) ||
        !process_.receive(std::as_writable_bytes(std::span(answer))))
      return std::nullopt;
    Result result{answer[0] == 0, std::vector<std::byte>(answer[1])};
    if (!process_.receive(result.bytes))
      return std::nullopt;
    return result;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::io, "the program that codes KTX2 " + what + "; \"" + words_ +
                                   "\" in a terminal says more");
  }

 private:
  std::string words_;
  storage::ChildProcess process_;
};

/// Processes that wait for pictures.
class IdleCoders {
 public:
  std::unique_ptr<Coder> take() {
    const std::lock_guard lock(mutex_);
    if (coders_.empty())
      return nullptr;
    std::unique_ptr<Coder> last = std::move(coders_.back());
    coders_.pop_back();
    return last;
  }
  void give(std::unique_ptr<Coder> coder) {
    const std::lock_guard lock(mutex_);
    coders_.push_back(std::move(coder));
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    coders_.clear();
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Coder>> coders_;
};

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

IdleCoders& idle_coders() {
  static IdleCoders coders;
  return coders;
}

std::unique_ptr<Coder> new_coder() {
  const Coding coding = find_coding();
  if (!coding.missing.empty())
    throw Error(ErrorCode::io, coding.missing);
  auto coder = std::make_unique<Coder>(coding);
  if (!coder->is_ready())
    coder->fail("does not start");
  return coder;
}

/// A process ends with the thread that started it, and when somebody kills it: others go on.
/// Nothing of a picture at which new ones end.
std::optional<Coder::Result> ask(const Request& request, std::span<const std::byte> bytes) {
  constexpr int kNewOnes = 2;
  for (int tried = 0; tried < kNewOnes;) {
    std::unique_ptr<Coder> coder = idle_coders().take();
    if (!coder) {
      coder = new_coder();
      ++tried;
    }
    if (std::optional<Coder::Result> result = coder->ask(request, bytes)) {
      if (result->is_good)
        idle_coders().give(std::move(coder));
      return result;
    }
  }
  return std::nullopt;
}

/// Red, green, blue, alpha.
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

std::vector<std::byte> encode_ktx2(const Image& image, Ktx2Content content, int quality) {
  assert(image.width % 4 == 0 && image.height % 4 == 0);
  assert(std::max(image.width, image.height) <= kMostKtx2Side);
  const std::vector<std::byte> texels = with_alpha(image);
  std::optional<Coder::Result> result =
      ask({static_cast<std::uint32_t>(content), image.width, image.height,
           static_cast<std::uint32_t>(quality), static_cast<std::uint32_t>(texels.size())},
          texels);
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
  const std::optional<Coder::Result> result =
      ask({kDecode, shape.width, shape.height, 0, static_cast<std::uint32_t>(file.size())}, file);
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

std::uint64_t coder_bytes(ImageFormat format, std::uint64_t texels) {
  if (format != ImageFormat::ktx2)
    return 0;
  // Measured for pictures of 64^2 to 3072^2 texels: the more there are, the less one takes.
  constexpr std::uint64_t kProcess = std::uint64_t{128} << 20;
  constexpr std::uint64_t kFew = std::uint64_t{1} << 18, kSome = std::uint64_t{3} << 18;
  constexpr std::uint64_t kOfFew = 1000, kOfSome = 250, kOfMany = 60;
  const std::uint64_t few = std::min(texels, kFew), some = std::min(texels, kSome);
  return kProcess + few * kOfFew + (some - few) * kOfSome + (texels - some) * kOfMany;
}

void end_ktx2_coders() {
  idle_coders().clear();
}

}  // namespace meshhier::images
