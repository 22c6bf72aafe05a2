#include "mesh_io/subtree.h"

#include "base/error.h"
#include "mesh_io/gltf_json.h"
#include "mesh_io/gltf_uri.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/part_of_file.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::string_view kSubtreeMagic = "subt";
constexpr std::size_t kSubtreeHeaderBytes = 24;
constexpr std::uint64_t kMostViewBytes = std::uint64_t{1} << 53;

/// The parts of a file.
struct SubtreeParts {
  std::string json;
  std::uint64_t begin = 0, bytes = 0;  ///< the bytes behind it
};

std::string text_at(const storage::File& file, std::uint64_t offset, std::uint64_t bytes,
                    std::uint64_t most_bytes) {
  if (bytes > most_bytes)
    throw Error(ErrorCode::budget,
                fmt::format("{}: its JSON takes {} bytes, more than there are; give a larger "
                            "memory_budget",
                            file.path().string(), bytes));
  std::string text(bytes, '\0');
  file.read_exact(offset, std::as_writable_bytes(std::span(text)));
  return text;
}

SubtreeParts parts_of(const storage::File& file, std::uint64_t most_bytes) {
  std::array<std::byte, kSubtreeHeaderBytes> header{};
  const std::size_t got = file.read_at(0, header);
  if (!std::string_view(reinterpret_cast<const char*>(header.data()), got)
           .starts_with(kSubtreeMagic))
    return {text_at(file, 0, file.size(), most_bytes)};
  if (got < header.size())
    fail_file(file.path(), "the subtree ends within its header (truncated?)");
  const auto version = storage::load_little<std::uint32_t>(header.data() + 4);
  if (version != 1)
    fail_file(file.path(), fmt::format("is a subtree of version {}, expected 1", version));
  const auto json = storage::load_little<std::uint64_t>(header.data() + 8);
  const auto binary = storage::load_little<std::uint64_t>(header.data() + 16);
  const std::uint64_t rest = file.size() - kSubtreeHeaderBytes;
  if (json > rest || binary > rest - json)
    fail_file(file.path(),
              fmt::format("is a subtree with {} and {} bytes behind its header as it says, and {} "
                          "follow (truncated?)",
                          json, binary, rest));
  std::string text = text_at(file, kSubtreeHeaderBytes, json, most_bytes);
  text.erase(text.find_last_not_of('\0') + 1);  // some programs pad it with zeros
  return {std::move(text), kSubtreeHeaderBytes + json, binary};
}

/// One reading of a subtree.
class SubtreeReader {
 public:
  SubtreeReader(const storage::File& file, const SubtreeParts& parts, const SubtreeShape& shape,
                std::size_t most_contents, std::uint64_t most_bytes, const OpenNamed& open,
                const GltfObject& root)
      : file_(file),
        parts_(parts),
        shape_(shape),
        most_contents_(most_contents),
        left_bytes_(most_bytes),
        open_(open),
        root_(root) {}

  Subtree read() {
    Subtree subtree;
    const std::uint64_t tiles = shape_.first_of(shape_.levels);
    subtree.tiles = availability(root_.require_object("tileAvailability"), tiles);
    const auto add = [&](const GltfObject& content) {
      if (subtree.contents.size() >= most_contents_)
        fail_file(file_.path(),
                  fmt::format("tells of {} contents of a tile, whose tileset names {}",
                              subtree.contents.size() + 1, most_contents_));
      subtree.contents.push_back(availability(content, tiles));
    };
    if (root_.has_object("contentAvailability"))  // of 1.0
      add(root_.require_object("contentAvailability"));
    else
      root_.for_each("contentAvailability", add);
    if (const auto several = root_.extension("3DTILES_multiple_contents"))
      several->for_each("contentAvailability", add);
    subtree.children = availability(root_.require_object("childSubtreeAvailability"),
                                    shape_.tiles_of(shape_.levels));
    return subtree;
  }

 private:
  Availability availability(const GltfObject& object, std::uint64_t bits) {
    if (const auto constant = object.count("constant", 1))
      return Availability(*constant == 1);
    const std::size_t views = root_.item_count("bufferViews");
    // The draft that came before 1.0 calls it so.
    const char* const key = object.has("bitstream") ? "bitstream" : "bufferView";
    const std::uint32_t view = object.require_index(key, views);
    return Availability(bits_of(*root_.item("bufferViews", view), (bits + 7) / 8));
  }

  /// Returns the first bytes of a view.
  std::vector<std::byte> bits_of(const GltfObject& view, std::uint64_t bytes) {
    const std::uint32_t number = view.require_index("buffer", root_.item_count("buffers"));
    const std::uint64_t offset = view.count("byteOffset", kMostViewBytes).value_or(0);
    const std::uint64_t size = view.require_count("byteLength", kMostViewBytes);
    const GltfObject buffer = *root_.item("buffers", number);
    if (size < bytes)
      view.fail(fmt::format("has {} bytes, expected {} for the tiles of {} levels", size, bytes,
                            shape_.levels));
    const std::uint64_t all = buffer.require_count("byteLength", kMostViewBytes);
    if (offset > all || bytes > all - offset)
      view.fail(fmt::format("reaches beyond its buffer, which has {} bytes", all));
    if (bytes > left_bytes_)
      throw Error(ErrorCode::budget, file_.path().string() +
                                         ": its bits take more memory than there is; give a larger "
                                         "memory_budget");
    left_bytes_ -= bytes;
    std::vector<std::byte> found(bytes);
    read_buffer(buffer, offset, found);
    return found;
  }

  void read_buffer(const GltfObject& buffer, std::uint64_t offset, std::span<std::byte> to) const {
    const auto uri = buffer.text("uri");
    if (!uri)
      return read_range(buffer, file_, parts_.begin, parts_.bytes, offset, to);
    if (const auto base64 = base64_of(*uri))
      return read_data(buffer, *base64, offset, to);
    const auto other =
        open_(file_.path().parent_path(), *uri, file_.path().string() + ": " + buffer.place());
    read_range(buffer, *other, 0, other->size(), offset, to);
  }

  static void read_range(const GltfObject& buffer, const storage::File& file, std::uint64_t begin,
                         std::uint64_t bytes, std::uint64_t offset, std::span<std::byte> to) {
    if (offset > bytes || to.size() > bytes - offset)
      buffer.fail(fmt::format("has {} bytes, fewer than it says (truncated?)", bytes));
    file.read_exact(begin + offset, to);
  }

  static void read_data(const GltfObject& buffer, std::string_view base64, std::uint64_t offset,
                        std::span<std::byte> to) {
    std::vector<std::byte> bytes;
    const bool is_sound = decode_base64(base64, [&](std::span<const std::byte> piece) {
      bytes.insert(bytes.end(), piece.begin(), piece.end());
    });
    if (!is_sound)
      buffer.fail("is a data URI that is no base64");
    if (offset > bytes.size() || to.size() > bytes.size() - offset)
      buffer.fail(fmt::format("has {} bytes, fewer than it says", bytes.size()));
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), to.size(), to.begin());
  }

  const storage::File& file_;
  const SubtreeParts& parts_;
  const SubtreeShape& shape_;
  std::size_t most_contents_;
  std::uint64_t left_bytes_;  ///< for bits
  const OpenNamed& open_;
  const GltfObject& root_;
};

}  // namespace

Subtree read_subtree(const storage::File& file, const SubtreeShape& shape,
                     std::size_t most_contents, std::uint64_t most_bytes, const OpenNamed& open) {
  const std::unique_ptr<storage::File> content = is_gzip(file) ? unpacked(file) : nullptr;
  const storage::File& plain = content ? *content : file;
  SubtreeParts parts = parts_of(plain, most_bytes);
  const nlohmann::json json = parse_gltf_json(std::move(parts.json), file.path(), most_bytes);
  const GltfObject root(json, file.path());
  return SubtreeReader(plain, parts, shape, most_contents, most_bytes, open, root).read();
}

}  // namespace meshhier::mesh_io
