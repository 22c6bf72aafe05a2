#include "import/open_picture.h"

#include "base/plain_text.h"
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
#include <string>
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

/// A picture of which the decoder holds more than its format tells.
class HungryReader : public images::ImageReader {
 public:
  HungryReader(std::unique_ptr<images::ImageReader> reader, std::uint64_t more_bytes)
      : reader_(std::move(reader)), info_(reader_->info()) {
    info_.decoder_bytes += more_bytes;
  }
  const images::ImageInfo& info() const override { return info_; }
  std::string missing() const override { return reader_->missing(); }
  void read_rows(std::uint8_t* rows, std::uint32_t count) override {
    reader_->read_rows(rows, count);
  }

 private:
  std::unique_ptr<images::ImageReader> reader_;
  images::ImageInfo info_;
};

std::unique_ptr<images::ImageReader> open_osgb(const images::ImageSource& source,
                                               storage::FileSystem& files, const std::string& name,
                                               std::uint64_t file_bytes) {
  const auto picture = std::make_shared<OsgbPicture>(source, files);
  auto reader = images::open_image(
      [picture](std::uint64_t at, std::span<std::byte> into) { return picture->read(at, into); },
      name);
  // Here it is a file; the program beside this one has texels, rows, a file and an answer.
  constexpr std::uint64_t kCopies = 5;
  const images::ImageInfo& info = reader->info();
  const std::uint64_t texels = std::uint64_t{info.width} * info.height * info.channels;
  return std::make_unique<HungryReader>(std::move(reader),
                                        mesh_io::osgb_reading_bytes(file_bytes) + kCopies * texels);
}

/// A picture within a file in gzip, as it is coded.
ByteSource unpacked(const images::ImageSource& source, storage::FileSystem& files) {
  const auto file = files.open(source.file);
  const auto stream = mesh_io::open_stream({*file, file->size()}, {});
  const auto bytes = std::make_shared<std::vector<std::byte>>(source.bytes);
  if (mesh_io::skip(*stream, source.offset) < source.offset || stream->read(*bytes) < bytes->size())
    mesh_io::fail_file(source.file, "ends before its picture (truncated?)");
  return bytes_of(*bytes, bytes);
}

/// Names a picture for messages by its file, or by the file that holds it: many tiles may have one
/// of the same name.
std::string name_with_file(const images::ImageSource& source) {
  constexpr std::size_t kLongest = 300;
  if (source.file.empty())
    return source.name;
  const std::string file = plain_text(source.file.string(), kLongest);
  return source.bytes == 0 && !source.is_packed ? file : file + ": " + source.name;
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
  const std::string name = name_with_file(source);
  if (source.is_packed) {
    const auto file = files.open(source.file);
    const auto format = mesh_io::find_format(*file);
    if (format && format->kind == mesh_io::MeshKind::osgb)
      return open_osgb(source, files, name, file->size());
  }
  return images::open_image(source_of(source, files), name);
}

}  // namespace meshhier::importing
