#include "mesh_io/part_of_file.h"

#include "mesh_io/input_stream.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <span>
#include <utility>

namespace meshhier::mesh_io {
namespace {

/// Reads up to so many bytes at an offset, fewer only at the end.
using ReadWithin = std::function<std::size_t(std::uint64_t, std::span<std::byte>)>;

class FileWithin final : public storage::ReadOnlyFile {
 public:
  FileWithin(std::filesystem::path path, std::uint64_t bytes, ReadWithin read)
      : ReadOnlyFile(std::move(path)), bytes_(bytes), read_(std::move(read)) {}

  std::uint64_t size() const override { return bytes_; }

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    if (offset >= bytes_)
      return 0;
    const std::uint64_t most = std::min<std::uint64_t>(bytes.size(), bytes_ - offset);
    return read_(offset, bytes.first(static_cast<std::size_t>(most)));
  }

 private:
  std::uint64_t bytes_;
  ReadWithin read_;
};

std::size_t copy_from(std::span<const std::byte> from, std::uint64_t offset,
                      std::span<std::byte> to) {
  const std::size_t count = std::min<std::uint64_t>(to.size(), from.size() - offset);
  if (count > 0)
    std::memcpy(to.data(), from.data() + offset, count);
  return count;
}

}  // namespace

std::unique_ptr<storage::File> part_of(std::shared_ptr<const storage::File> file,
                                       std::uint64_t offset, std::uint64_t bytes) {
  std::filesystem::path path = file->path();
  return std::make_unique<FileWithin>(
      std::move(path), bytes,
      [file = std::move(file), offset](std::uint64_t at, std::span<std::byte> to) {
        return file->read_at(offset + at, to);
      });
}

std::unique_ptr<storage::File> file_of_bytes(std::filesystem::path path,
                                             std::shared_ptr<const std::vector<std::byte>> bytes) {
  const std::uint64_t size = bytes->size();
  return std::make_unique<FileWithin>(
      std::move(path), size, [bytes = std::move(bytes)](std::uint64_t at, std::span<std::byte> to) {
        return copy_from(*bytes, at, to);
      });
}

std::unique_ptr<storage::File> unpacked(const storage::File& file) {
  constexpr std::size_t kHeadBytes = std::size_t{1} << 20;
  auto head = std::make_shared<std::vector<std::byte>>(kHeadBytes);
  const auto stream = open_stream({file, file.size()}, {});
  head->resize(stream->read(*head));
  const std::uint64_t size =
      head->size() + (head->size() < kHeadBytes ? 0 : skip(*stream, UINT64_MAX));
  return std::make_unique<FileWithin>(file.path(), size,
                                      [&file, head](std::uint64_t at, std::span<std::byte> to) {
                                        if (at + to.size() <= head->size())
                                          return copy_from(*head, at, to);
                                        const auto again = open_stream({file, file.size()}, {});
                                        skip(*again, at);
                                        return again->read(to);
                                      });
}

}  // namespace meshhier::mesh_io
