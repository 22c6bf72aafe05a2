#include "import/open_picture.h"

#include "images/tiff_picture.h"
#include "mesh_io/formats.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/osgb_tiles.h"
#include "mesh_io/part_of_file.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::importing {
namespace {

using images::ByteSource;

/// Bytes [offset, offset + size) of a file.
ByteSource bytes_of(std::shared_ptr<storage::File> file, std::uint64_t offset, std::uint64_t size) {
  return [file = std::move(file), offset, size](std::uint64_t at, std::span<std::byte> into) {
    const std::uint64_t left = at < size ? size - at : 0;
    return file->read_at(offset + at, into.first(std::min<std::uint64_t>(left, into.size())));
  };
}

/// Bytes in memory; `owner`, if there is one, has them.
ByteSource bytes_of(std::span<const std::byte> data, std::shared_ptr<const void> owner = {}) {
  return [data, owner = std::move(owner)](std::uint64_t at, std::span<std::byte> into) {
    const std::size_t count = at < data.size() ? std::min(data.size() - at, into.size()) : 0;
    if (count > 0)
      std::memcpy(into.data(), data.data() + at, count);
    return count;
  };
}

/// A picture within what is made of an OSGB file to read it: its start, then all of it. Its texels
/// are decoded when they are asked for.
class OsgbPicture {
 public:
  OsgbPicture(const images::ImageSource& source, storage::FileSystem& files)
      : offset_(source.offset), read_(mesh_io::OsgbTiles(files, kMost).read(source.file)) {
    const auto& glb = *read_.tile.glb;
    if (source.offset > glb.size() || source.bytes > glb.size() - source.offset)
      mesh_io::fail_file(source.file, "does not have its picture any more");
    const std::span start = std::span(glb).subspan(source.offset, source.bytes);
    bytes_.assign(start.begin(), start.end());
    read_.tile.glb.reset();
  }

  std::size_t read(std::uint64_t at, std::span<std::byte> into) {
    if (at >= bytes_.size() && !std::exchange(is_whole_, true))
      bytes_ = mesh_io::picture_of(read_, offset_);
    return bytes_of(bytes_)(at, into);
  }

 private:
  static constexpr std::uint64_t kMost = std::uint64_t{1}
                                         << 31;  // the import has read it with less

  std::uint64_t offset_;
  mesh_io::OsgbRead read_;
  std::vector<std::byte> bytes_;
  bool is_whole_ = false;
};

ByteSource of_osgb(const images::ImageSource& source, storage::FileSystem& files) {
  const auto picture = std::make_shared<OsgbPicture>(source, files);
  return [picture](std::uint64_t at, std::span<std::byte> into) { return picture->read(at, into); };
}

/// A picture within a file in gzip, as it is coded.
ByteSource unpacked(const images::ImageSource& source, storage::FileSystem& files) {
  const auto file = files.open(source.file);
  if (const auto format = mesh_io::find_format(*file);
      format && format->kind == mesh_io::MeshKind::osgb)
    return of_osgb(source, files);
  const auto stream = mesh_io::open_stream({*file, file->size()}, {});
  const auto bytes = std::make_shared<std::vector<std::byte>>(source.bytes);
  if (mesh_io::skip(*stream, source.offset) < source.offset || stream->read(*bytes) < bytes->size())
    mesh_io::fail_file(source.file, "ends before its picture (truncated?)");
  return bytes_of(*bytes, bytes);
}

ByteSource source_of(const images::ImageSource& source, storage::FileSystem& files) {
  if (source.is_packed)
    return unpacked(source, files);
  if (source.file.empty())
    return bytes_of(source.data);
  std::shared_ptr<storage::File> file = files.open(source.file);
  const std::uint64_t size = file->size();
  const std::uint64_t offset = std::min(source.offset, size);
  const std::uint64_t bytes =
      source.bytes > 0 ? std::min(source.bytes, size - offset) : size - offset;
  return bytes_of(std::move(file), offset, bytes);
}

}  // namespace

std::unique_ptr<images::ImageReader> open_picture(const images::ImageSource& source,
                                                  storage::FileSystem& files) {
  if (source.is_drape)
    return images::open_framed_tiff(files.open(source.file), source.name);
  return images::open_image(source_of(source, files), source.name);
}

}  // namespace meshhier::importing
