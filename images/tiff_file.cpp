#include "images/tiff_file.h"

#include "base/plain_text.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <new>
#include <utility>

namespace meshhier::images {
namespace {

constexpr std::size_t kMostMessage = 200;

}  // namespace

/// What the library calls. No exception passes through its frames: it waits in the TiffFile.
struct TiffFile::Calls {
  static TiffFile& of(void* self) { return *static_cast<TiffFile*>(self); }

  template <class Work>
  static tmsize_t kept(TiffFile& tiff, const Work& work) noexcept {
    try {
      return static_cast<tmsize_t>(work());
    } catch (...) {
      if (!tiff.caught_)
        tiff.caught_ = std::current_exception();
      return -1;
    }
  }

  static tmsize_t read(void* self, void* into, tmsize_t bytes) {
    TiffFile& tiff = of(self);
    return kept(tiff, [&] {
      const std::span to(static_cast<std::byte*>(into), static_cast<std::size_t>(bytes));
      const std::size_t count = tiff.file_.read_at(tiff.position_, to);
      tiff.position_ += count;
      return count;
    });
  }

  static tmsize_t write(void* /*self*/, void* /*from*/, tmsize_t /*bytes*/) { return -1; }

  static toff_t seek(void* self, toff_t offset, int whence) {
    TiffFile& tiff = of(self);
    const std::uint64_t from = whence == SEEK_CUR   ? tiff.position_
                               : whence == SEEK_END ? size(self)
                                                    : 0;
    return tiff.position_ = from + offset;
  }

  static toff_t size(void* self) {
    TiffFile& tiff = of(self);
    return static_cast<toff_t>(
        std::max<tmsize_t>(0, kept(tiff, [&] { return tiff.file_.size(); })));
  }

  static int close(void* /*self*/) { return 0; }

  static int say(TIFF* /*tiff*/, void* self, const char* /*where*/, const char* format,
                 va_list arguments) {
    TiffFile& tiff = of(self);
    std::array<char, kMostMessage> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    std::string_view said(text.data());
    if (said.starts_with(": "))  // it begins with the file's name, which is not the library's
      said.remove_prefix(2);
    if (tiff.message_.empty())  // the first one is the cause
      kept(tiff, [&] { return tiff.message_ = plain_text(said, kMostMessage), 0; });
    return 1;
  }

  static int ignore(TIFF* /*tiff*/, void* /*self*/, const char* /*where*/, const char* /*format*/,
                    va_list /*arguments*/) {
    return 1;
  }
};

void TiffFile::Close::operator()(TIFF* tiff) const {
  TIFFCleanup(tiff);  // unlike TIFFClose() it writes nothing
}

TiffFile::TiffFile(const storage::File& file, std::uint64_t most_bytes) : file_(file) {
  struct Free {
    void operator()(TIFFOpenOptions* options) const { TIFFOpenOptionsFree(options); }
  };
  const std::unique_ptr<TIFFOpenOptions, Free> options(TIFFOpenOptionsAlloc());
  if (options == nullptr)
    throw std::bad_alloc();
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(),
                                      static_cast<tmsize_t>(std::min<std::uint64_t>(
                                          most_bytes, std::numeric_limits<tmsize_t>::max())));
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), Calls::say, this);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), Calls::ignore, this);
  constexpr const char* kMode = "rmO";  // not mapped; tables of blocks as far as they are needed
  tiff_.reset(TIFFClientOpenExt("", kMode, this, Calls::read, Calls::write, Calls::seek,
                                Calls::close, Calls::size, nullptr, nullptr, options.get()));
  check(tiff_ != nullptr);
}

TiffFile::~TiffFile() = default;

void TiffFile::fail(std::string_view message) const {
  throw Error(ErrorCode::input, file_.path().string() + ": " + std::string(message));
}

void TiffFile::check(bool succeeded) {
  const std::string message = std::exchange(message_, {});
  if (caught_)
    std::rethrow_exception(std::exchange(caught_, nullptr));
  if (!succeeded)
    fail(message.empty() ? "libtiff cannot go on" : "libtiff says: " + message);
}

template <class Value>
std::vector<Value> TiffFile::values(GeoTag tag, TIFFDataType type) {
  const TIFFField* field = TIFFFindField(tiff_.get(), static_cast<std::uint32_t>(tag), type);
  std::uint32_t count = 0;
  const Value* first = nullptr;
  const bool found =
      field != nullptr && TIFFFieldDataType(field) == type && TIFFFieldPassCount(field) != 0 &&
      TIFFFieldReadCount(field) == TIFF_VARIABLE2 &&
      TIFFGetField(tiff_.get(), static_cast<std::uint32_t>(tag), &count, &first) == 1;
  check(true);
  return found && first != nullptr ? std::vector<Value>(first, first + count)
                                   : std::vector<Value>();
}

std::vector<double> TiffFile::doubles(GeoTag tag) {
  return values<double>(tag, TIFF_DOUBLE);
}

std::vector<std::uint16_t> TiffFile::shorts(GeoTag tag) {
  return values<std::uint16_t>(tag, TIFF_SHORT);
}

std::string TiffFile::text(GeoTag tag) {
  const std::vector<char> characters = values<char>(tag, TIFF_ASCII);
  return {characters.begin(), std::ranges::find(characters, '\0')};
}

void TiffFile::select(std::uint64_t directory) {
  if (TIFFCurrentDirOffset(tiff_.get()) != directory)
    check(TIFFSetSubDirectory(tiff_.get(), directory) == 1);
}

storage::File::Range TiffFile::place_of(std::uint32_t index) {
  int failed = 0;
  const std::uint64_t offset = TIFFGetStrileOffsetWithErr(tiff_.get(), index, &failed);
  check(failed == 0);
  const std::uint64_t bytes = TIFFGetStrileByteCountWithErr(tiff_.get(), index, &failed);
  check(failed == 0);
  const std::uint64_t size = file_.size();
  if (offset > size || bytes > size - offset) {
    fail("block " + std::to_string(index) + " would lie at byte " + std::to_string(offset) +
         ", with " + std::to_string(bytes) + " bytes, but the file has " + std::to_string(size) +
         "; it may have been cut off");
  }
  return {offset, bytes};
}

void TiffFile::read_block(std::uint32_t index, std::span<std::byte> into) {
  place_of(index);
  const auto room = static_cast<tmsize_t>(into.size());
  const tmsize_t read = TIFFIsTiled(tiff_.get()) != 0
                            ? TIFFReadEncodedTile(tiff_.get(), index, into.data(), room)
                            : TIFFReadEncodedStrip(tiff_.get(), index, into.data(), room);
  check(read >= 0);
  // Else each handle keeps the packed bytes of its largest block.
  check(TIFFReadBufferSetup(tiff_.get(), nullptr, 1) == 1);
  if (read != room) {
    fail("block " + std::to_string(index) + " has " + std::to_string(read) + " bytes, expected " +
         std::to_string(room));
  }
}

}  // namespace meshhier::images
