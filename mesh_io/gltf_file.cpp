#include "mesh_io/gltf_file.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "mesh_io/gltf_extensions.h"
#include "mesh_io/gltf_meshopt.h"
#include "mesh_io/gltf_uri.h"
#include "mesh_io/input_error.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

// GLB container (glTF 2.0 specification, section 4.4), little endian:
//
//   0  magic "glTF", container version 2, length of the file
//   12 chunks: length of the data, kind ("JSON", the first; "BIN\0", the second, may be missing;
//      others are ignored), the data
constexpr std::uint32_t kGlbMagic = 0x46546C67;
constexpr std::uint32_t kGlbVersion = 2;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinChunk = 0x004E4942;
constexpr std::uint64_t kGlbHeaderBytes = 12;
constexpr std::uint64_t kGlbChunkBytes = 8;

constexpr std::size_t kLongestUri = 255;

std::uint32_t word(std::span<const std::byte> bytes, std::size_t index) {
  return storage::load_little<std::uint32_t>(bytes.data() + 4 * index);
}

struct Chunk {
  std::uint32_t kind = 0;
  std::uint64_t offset = 0, bytes = 0;  ///< the place of its data
  std::uint64_t end() const { return offset + bytes; }
};

/// The chunk at `offset`; `end`: of the GLB.
Chunk read_chunk(const storage::File& file, std::uint64_t offset, std::uint64_t end) {
  if (end - offset < kGlbChunkBytes)
    fail_at_byte(file.path(), offset, "the GLB ends within the header of a chunk (truncated?)");
  std::array<std::byte, kGlbChunkBytes> header{};
  file.read_exact(offset, header);
  const Chunk chunk{word(header, 1), offset + kGlbChunkBytes, word(header, 0)};
  if (chunk.bytes > end - chunk.offset) {
    fail_at_byte(
        file.path(), offset,
        fmt::format("a chunk of {} bytes begins, but the GLB has only {} more (truncated?)",
                    chunk.bytes, end - chunk.offset));
  }
  return chunk;
}

std::string buffer_name(std::size_t index) {
  return fmt::format("buffers[{}]", index);
}

}  // namespace

GltfFile::GltfFile(std::shared_ptr<const storage::File> file, std::filesystem::path folder,
                   GltfRoom room)
    : file_(std::move(file)), folder_(std::move(folder)), room_(std::move(room)) {
  std::string json = read_container();
  constexpr std::uint64_t kParsed = 30;  // bytes for one of the text, at most
  const auto taken = take_memory(std::min(kParsed * json.size(), room_.memory_bytes), "its JSON");
  document_ = read_gltf_document(std::move(json), path(), room_.memory_bytes);
  buffers_.resize(document_.buffers.size());
  decoded_.resize(document_.views.size());
}

void GltfFile::fail(const std::string& message) const {
  fail_file(path(), message);
}

void GltfFile::require_memory(std::uint64_t bytes, const std::string& what) const {
  if (bytes > room_.memory_bytes) {
    throw Error(ErrorCode::budget,
                fmt::format("{}: {} takes {} bytes of memory to be read, the import has {}; give a "
                            "larger memory_budget",
                            path().string(), what, bytes, room_.memory_bytes));
  }
}

std::shared_ptr<const void> GltfFile::take_memory(std::uint64_t bytes,
                                                  const std::string& what) const {
  require_memory(bytes, what);
  return room_.take_memory ? room_.take_memory(bytes) : nullptr;
}

std::string GltfFile::read_text(std::uint64_t offset, std::uint64_t bytes) const {
  require_memory(bytes, "its JSON");
  std::string text(bytes, '\0');
  file_->read_exact(offset, std::as_writable_bytes(std::span(text)));
  return text;
}

std::string GltfFile::read_container() {
  const std::uint64_t size = file_->size();
  std::array<std::byte, kGlbHeaderBytes> header{};
  const std::size_t got = file_->read_at(0, header);
  if (got < 4 || word(header, 0) != kGlbMagic)
    return read_text(0, size);
  if (got < kGlbHeaderBytes)
    fail("the GLB ends within its header (truncated?)");
  if (word(header, 1) != kGlbVersion) {
    fail(fmt::format("is a GLB of version {}, expected 2; {}", word(header, 1), kUpgradeGltf));
  }
  const std::uint64_t end = word(header, 2);
  if (end > size)
    fail(fmt::format("is a GLB of {} bytes, but the file has {} (truncated?)", end, size));
  if (end < kGlbHeaderBytes)
    fail(fmt::format("is a GLB of {} bytes as it says, fewer than its header has", end));
  const Chunk json = read_chunk(*file_, kGlbHeaderBytes, end);
  if (json.kind != kJsonChunk)
    fail("the first chunk of the GLB is not its JSON");
  if (json.end() < end) {
    const Chunk bin = read_chunk(*file_, json.end(), end);
    if (bin.kind == kBinChunk) {
      chunk_.emplace(file_, bin.offset, bin.bytes);
      chunk_offset_ = bin.offset;
    }
  }
  return read_text(json.offset, json.bytes);
}

bool GltfFile::is_regular(const std::filesystem::path& path) const {
  return room_.files.kind(path) == storage::FileKind::regular;
}

GltfFile::Buffer GltfFile::open_file(const std::filesystem::path& path,
                                     const std::string& name) const {
  if (!is_regular(path))
    fail(fmt::format("{}: {} is not there, or no regular file", name,
                     plain_text(path.string(), kLongestUri)));
  std::shared_ptr<const storage::File> file = room_.files.open(path);
  const std::uint64_t bytes = file->size();
  return {std::make_unique<GltfFileBytes>(std::move(file), 0, bytes), path, 0};
}

std::unique_ptr<GltfBytes> GltfFile::decode_data(std::string_view base64,
                                                 const std::string& name) const {
  auto bytes = std::make_unique<GltfSpoolBytes>(room_.scratch);
  const bool sound = decode_base64(base64, [&](std::span<const std::byte> piece) {
    room_.check();
    bytes->append(piece);
  });
  if (!sound)
    fail(name + ": its data URI is no base64");
  return bytes;
}

GltfFile::Buffer GltfFile::open_buffer(std::uint32_t index) const {
  const std::string name = buffer_name(index);
  const GltfBuffer& buffer = document_.buffers[index];
  if (!buffer.uri) {
    if (index != 0 || !chunk_)
      fail(name + " has neither a \"uri\" nor the second chunk of a GLB");
    return {std::make_unique<GltfFileBytes>(*chunk_), path(), chunk_offset_};
  }
  return open_uri(*buffer.uri, name);
}

GltfFile::Buffer GltfFile::open_uri(const std::string& uri, const std::string& name) const {
  if (const auto base64 = base64_of(uri))
    return {decode_data(*base64, name), {}, 0};
  const auto file = file_of_uri(uri, folder_);
  if (!file) {
    fail(
        fmt::format("{}: \"{}\" is no relative path below the folder of the file; copy the buffer "
                    "beside it",
                    name, plain_text(uri, kLongestUri)));
  }
  return open_file(*file, name);
}

std::string GltfFile::text_of(const std::string& uri, const std::string& what) const {
  const Buffer content = open_uri(uri, what);
  require_memory(content.bytes->size(), what);
  std::string text(static_cast<std::size_t>(content.bytes->size()), '\0');
  content.bytes->read(0, std::as_writable_bytes(std::span(text)));
  return text;
}

const GltfFile::Buffer& GltfFile::buffer(std::uint32_t index) {
  Buffer& buffer = buffers_[index];
  if (!buffer.bytes) {
    buffer = open_buffer(index);
    const std::uint64_t expected = document_.buffers[index].bytes;
    if (buffer.bytes->size() < expected) {
      fail(fmt::format("{} has {} bytes, expected {} (truncated?)", buffer_name(index),
                       buffer.bytes->size(), expected));
    }
  }
  return buffer;
}

GltfRange GltfFile::range(std::uint32_t index, std::uint64_t offset, std::uint64_t bytes,
                          const std::string& name) {
  const std::uint64_t size = document_.buffers[index].bytes;
  if (offset > size || bytes > size - offset) {
    fail(fmt::format("{} has {} bytes from byte {} of {}, which has {}", name, bytes, offset,
                     buffer_name(index), size));
  }
  return {buffer(index).bytes.get(), offset, bytes};
}

std::unique_ptr<GltfBytes> GltfFile::decode_view(const GltfMeshopt& packed,
                                                 const std::string& name) {
  const std::string fault = meshopt_fault(packed);
  if (!fault.empty())
    fail(name + ": " + fault);
  const GltfRange range = this->range(packed.buffer, packed.offset, packed.bytes, name);
  const auto taken = take_memory(range.size + packed.count * packed.stride, name);
  room_.check();
  std::vector<std::byte> stream(range.size);
  range.read(0, stream);
  std::vector<std::byte> plain(packed.count * packed.stride);
  if (!decode_meshopt(packed, stream, plain))
    fail(name + " is no stream of EXT_meshopt_compression of that mode, size and count");
  auto bytes = std::make_unique<GltfSpoolBytes>(room_.scratch);
  bytes->append(plain);
  return bytes;
}

GltfRange GltfFile::view(std::uint32_t index) {
  const GltfView& view = document_.views[index];
  const std::string name = fmt::format("bufferViews[{}]", index);
  if (!view.meshopt)
    return range(view.buffer, view.offset, view.bytes, name);
  std::unique_ptr<GltfBytes>& decoded = decoded_[index];
  if (!decoded)
    decoded = decode_view(*view.meshopt, name);
  if (decoded->size() < view.bytes) {
    fail(fmt::format("{} has {} bytes, but is compressed from {}", name, view.bytes,
                     decoded->size()));
  }
  return {decoded.get(), 0, view.bytes};
}

void GltfFile::find_picture(std::string_view uri, GltfPicture& picture) {
  picture.name = plain_text(std::string(uri), kLongestUri);
  for (const std::string& name : names_of_uri(uri)) {
    if ((picture.file = named_.find(folder_, name)))
      return;
  }
  for (const std::string& name : names_of_uri(uri)) {
    const auto places = sought_places(folder_, name);
    picture.sought.insert(picture.sought.end(), places.begin(), places.end());
  }
}

GltfPicture GltfFile::picture(std::uint32_t index) {
  const GltfImage& image = document_.images[index];
  const std::string name = fmt::format("images[{}]", index);
  GltfPicture picture{.name = image.name.empty() ? name : image.name};
  if (image.view) {
    const GltfView& view = document_.views[*image.view];
    if (view.meshopt)
      fail(name + " lies in a compressed buffer view, which is not read");
    const GltfRange range = this->view(*image.view);
    const Buffer& buffer = this->buffer(view.buffer);
    if (range.size == 0)
      fail(name + " has no bytes");
    const bool is_own = buffer.file == path();
    if (!buffer.file.empty() && !(is_own && room_.content == GltfContent::fleeting)) {
      picture.file = is_own ? room_.stored_in : buffer.file;
      picture.offset = buffer.offset + range.offset + (is_own ? room_.begin : 0);
      picture.bytes = range.size;
      picture.is_packed = is_own && room_.content == GltfContent::packed;
      if (picture.is_packed && room_.find_plain) {
        if (const auto plain = room_.find_plain(picture.offset, picture.bytes)) {
          picture.offset = *plain;
          picture.is_packed = false;
        }
      }
      if (picture.is_packed)
        require_memory(range.size, name);  // it is held as a whole
    } else {
      require_memory(range.size, name);
      picture.data.resize(range.size);
      range.read(0, picture.data);
    }
  } else if (image.uri) {
    if (const auto base64 = base64_of(*image.uri)) {
      const auto take = [&](std::span<const std::byte> piece) {
        picture.data.insert(picture.data.end(), piece.begin(), piece.end());
      };
      if (!decode_base64(*base64, take))
        fail(name + ": its data URI is no base64");
    } else {
      find_picture(*image.uri, picture);
    }
  }
  return picture;
}

}  // namespace meshhier::mesh_io
