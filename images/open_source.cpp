#include "images/open_source.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>

namespace meshhier::images {
namespace {

/// Bytes [offset, offset + size) of a file.
ByteSource bytes_of(std::shared_ptr<storage::File> file, std::uint64_t offset, std::uint64_t size) {
  return [file = std::move(file), offset, size](std::uint64_t at, std::span<std::byte> into) {
    const std::uint64_t left = at < size ? size - at : 0;
    return file->read_at(offset + at, into.first(std::min<std::uint64_t>(left, into.size())));
  };
}

/// Bytes in memory, which outlive the reader.
ByteSource bytes_of(std::span<const std::byte> data) {
  return [data](std::uint64_t at, std::span<std::byte> into) {
    const std::size_t count = at < data.size() ? std::min(data.size() - at, into.size()) : 0;
    if (count > 0)
      std::memcpy(into.data(), data.data() + at, count);
    return count;
  };
}

}  // namespace

std::unique_ptr<ImageReader> open_source(const ImageSource& source, storage::FileSystem& files) {
  if (source.file.empty())
    return open_image(bytes_of(source.data), source.name);
  std::shared_ptr<storage::File> file = files.open(source.file);
  const std::uint64_t size = file->size();
  const std::uint64_t offset = std::min(source.offset, size);
  const std::uint64_t bytes =
      source.bytes > 0 ? std::min(source.bytes, size - offset) : size - offset;
  return open_image(bytes_of(std::move(file), offset, bytes), source.name);
}

}  // namespace meshhier::images
