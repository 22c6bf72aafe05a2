#include "storage/format/index.h"

#include "base/error.h"
#include "storage/format/glb.h"
#include "storage/format/tile_glb.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

// tiles.bin, little endian: a header, then one record a tile, ascending by level, then index.
//
//   header                                     record
//   offset  bytes  what                        offset  bytes  what
//        0      8  magic "MHTILES\n"                0      4  level
//        8      4  version, 4 or 5                  4      4  index
//       12      4  bytes of a record, 120           8      4  own places
//       16      8  number of records               12      4  boundary places
//       24      8  XXH3-64 of bytes 0 to 23        16      4  ghosts
//                  and all records                 20      4  copies
//                                                  24      4  interior triangles
//                                                  28      4  border triangles
//                                                  32      4  border triangles drawn
//                                                  36      4  places asked for
//                                                  40      4  places torn away
//                                                  44      4  places forced away
//                                                  48      4  f32 error
//                                                  52      4  f32 bound
//                                                  56      4  f32 compactness
//                                                  60     24  f32 min x y z, max x y z
//                                                  84      4  splits
//                                                  88      4  width of the picture
//                                                  92      4  height of the picture
//                                                  96      4  f32 texel
//                                                 100      4  version 5: 1, the picture is a
//                                                            normal map; else 0
//                                                 104      8  bytes of the file
//                                                 112      8  XXH3-64 of the file
constexpr std::string_view kIndexMagic = "MHTILES\n";
/// The versions for hierarchies with normal maps, and for others.
constexpr std::uint32_t kIndexVersion = 5;
constexpr std::uint32_t kNoMapsIndexVersion = 4;
constexpr std::size_t kIndexHeaderBytes = 32;
constexpr std::size_t kCheckedHeaderBytes = 24;
constexpr std::size_t kMapOffset = 100;
constexpr std::size_t kRecordBytes = 120;

void append_record(std::vector<std::byte>& bytes, const TileRecord& record) {
  for (const std::uint32_t value :
       {std::uint32_t{raw(record.node.level)}, record.node.index, record.own_count,
        record.boundary_count, record.ghost_count, record.copy_count, record.interior_count,
        record.border_count, record.drawn_border_count, record.target_count, record.torn_count,
        record.forced_count}) {
    append_little(bytes, value);
  }
  const Bounds& box = record.bounds;
  for (const float value : {record.error, record.bound, record.compactness, box.min.x, box.min.y,
                            box.min.z, box.max.x, box.max.y, box.max.z}) {
    append_little(bytes, value);
  }
  for (const std::uint32_t value : {record.split_count, record.image_width, record.image_height})
    append_little(bytes, value);
  append_little(bytes, record.texel);
  append_little(bytes, std::uint32_t{record.has_normal_map});
  append_little(bytes, record.file_bytes);
  append_little(bytes, record.checksum);
}

std::uint64_t index_checksum(std::span<const std::byte> bytes) {
  Checksum sum;
  sum.add(bytes.first(kCheckedHeaderBytes));
  sum.add(bytes.subspan(kIndexHeaderBytes));
  return sum.value();
}

/// Parses a record. `from`: kRecordBytes bytes whose level was checked to be below 256.
TileRecord load_record(const std::byte* from) {
  const auto count = [&](std::size_t offset) { return load_little<std::uint32_t>(from + offset); };
  const auto real = [&](std::size_t offset) { return load_little<float>(from + offset); };
  TileRecord record;
  record.node = {static_cast<Level>(count(0)), count(4)};
  record.own_count = count(8);
  record.boundary_count = count(12);
  record.ghost_count = count(16);
  record.copy_count = count(20);
  record.interior_count = count(24);
  record.border_count = count(28);
  record.drawn_border_count = count(32);
  record.target_count = count(36);
  record.torn_count = count(40);
  record.forced_count = count(44);
  record.error = real(48);
  record.bound = real(52);
  record.compactness = real(56);
  record.bounds = {{real(60), real(64), real(68)}, {real(72), real(76), real(80)}};
  record.split_count = count(84);
  record.image_width = count(88);
  record.image_height = count(92);
  record.texel = real(96);
  record.has_normal_map = count(kMapOffset) != 0;
  record.file_bytes = load_little<std::uint64_t>(from + 104);
  record.checksum = load_little<std::uint64_t>(from + 112);
  return record;
}

bool is_measure(float value) {
  return std::isfinite(value) && value >= 0;
}

/// Returns a flaw in what a record says of the tile's picture; null if there is none.
const char* image_flaw_of(const TileRecord& record) {
  const auto [least, most] = std::minmax({record.image_width, record.image_height});
  if (most > kMaxImageSide || (least == 0 && most > 0))
    return "size of the picture";
  if (most > 0 && record.interior_count == 0 && record.border_count == 0)
    return "picture (of no triangle)";
  if (most == 0 && record.has_normal_map)
    return "normal map (without a size)";
  if (!is_measure(record.texel) || (most == 0 && record.texel > 0))
    return "texel";
  return nullptr;
}

/// Returns a flaw in the values of a record; null if there is none.
const char* flaw_of(const TileRecord& record, const Tree& tree) {
  const Bounds& box = record.bounds;
  const bool finite = std::isfinite(box.min.x) && std::isfinite(box.min.y) &&
                      std::isfinite(box.min.z) && std::isfinite(box.max.x) &&
                      std::isfinite(box.max.y) && std::isfinite(box.max.z);
  if (record.own_count == 0 || record.own_count > kMaxOwnVertices)
    return "own vertices";
  if (tree.is_partition(record.node) && record.own_count != tree.ranks(record.node).size()) {
    return "own vertices (not the partition's)";
  }
  if (record.boundary_count > record.own_count)
    return "boundary vertices (more than own)";
  if (record.drawn_border_count > record.border_count)
    return "drawn border triangles";
  if (record.split_count > most_splits(record.interior_count, record.border_count))
    return "splits (more than corners of triangles)";
  if (!is_measure(record.error))
    return "error";
  if (!is_measure(record.bound))
    return "bound";
  if (!is_measure(record.compactness))
    return "compactness";
  if (!finite || box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z) {
    return "bounds";
  }
  if (record.file_bytes == 0)
    return "bytes of the file";
  return image_flaw_of(record);
}

class IndexReader {
 public:
  IndexReader(std::span<const std::byte> bytes, const Tree& tree, const std::string& name)
      : bytes_(bytes), tree_(tree), name_(name) {}

  std::vector<TileRecord> read() const {
    check_header();
    std::vector<TileRecord> records;
    records.reserve(tree_.tile_count());
    for (const NodeId node : tree_.tile_nodes())
      records.push_back(read_record(records.size(), node));
    return records;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::corrupt, name_ + ": " + what);
  }

  void check_header() const {
    if (bytes_.size() < kIndexHeaderBytes) {
      fail(fmt::format("has {} bytes, expected at least {}", bytes_.size(), kIndexHeaderBytes));
    }
    const auto magic = std::as_bytes(std::span(kIndexMagic));
    if (!std::equal(magic.begin(), magic.end(), bytes_.begin())) {
      fail("does not start with MHTILES: not an index");
    }
    const auto version = load_little<std::uint32_t>(bytes_.data() + 8);
    if (version != kIndexVersion && version != kNoMapsIndexVersion) {
      fail(fmt::format("version is {}, expected {} or {}{}", version, kNoMapsIndexVersion,
                       kIndexVersion,
                       version > kIndexVersion ? " (written by a newer meshhier)" : ""));
    }
    const auto record_bytes = load_little<std::uint32_t>(bytes_.data() + 12);
    if (record_bytes != kRecordBytes) {
      fail(fmt::format("records of {} bytes, expected {}", record_bytes, kRecordBytes));
    }
    const auto count = load_little<std::uint64_t>(bytes_.data() + 16);
    if (count != tree_.tile_count()) {
      fail(fmt::format("{} records, expected {} for {} partitions", count, tree_.tile_count(),
                       tree_.partition_count()));
    }
    const std::uint64_t expected = index_bytes(tree_);
    if (bytes_.size() != expected) {
      fail(fmt::format("has {} bytes, expected {}", bytes_.size(), expected));
    }
    const auto sum = load_little<std::uint64_t>(bytes_.data() + kCheckedHeaderBytes);
    if (sum != index_checksum(bytes_)) {
      fail(fmt::format("checksum is {:016x}, expected {:016x}: the file is damaged",
                       index_checksum(bytes_), sum));
    }
  }

  bool may_have_maps() const {
    return load_little<std::uint32_t>(bytes_.data() + 8) == kIndexVersion;
  }

  TileRecord read_record(std::size_t number, NodeId node) const {
    const std::byte* from = bytes_.data() + kIndexHeaderBytes + number * kRecordBytes;
    const auto level = load_little<std::uint32_t>(from);
    const auto index = load_little<std::uint32_t>(from + 4);
    if (level != raw(node.level) || index != node.index) {
      fail(fmt::format("record {} is of tile {}/{}, expected {}/{}", number, level, index,
                       raw(node.level), node.index));
    }
    if (load_little<std::uint32_t>(from + kMapOffset) > (may_have_maps() ? 1 : 0))
      fail(fmt::format("tile {}/{}: bytes that have to be 0 are not", level, index));
    const TileRecord record = load_record(from);
    if (const char* flaw = flaw_of(record, tree_)) {
      fail(fmt::format("tile {}/{}: impossible {}", level, index, flaw));
    }
    return record;
  }

  std::span<const std::byte> bytes_;
  const Tree& tree_;
  const std::string& name_;
};

}  // namespace

std::vector<std::byte> encode_record(const TileRecord& record) {
  std::vector<std::byte> bytes;
  bytes.reserve(kRecordBytes);
  append_record(bytes, record);
  return bytes;
}

TileRecord decode_record(std::span<const std::byte> bytes) {
  if (bytes.size() != kRecordBytes || load_little<std::uint32_t>(bytes.data()) > 255)
    throw Error(ErrorCode::corrupt, "no record of a tile");
  return load_record(bytes.data());
}

std::uint64_t index_bytes(const Tree& tree) {
  return index_bytes(tree.tile_count());
}

std::uint64_t index_bytes(std::uint64_t records) {
  return kIndexHeaderBytes + records * kRecordBytes;
}

std::vector<std::byte> encode_index(std::span<const TileRecord> records) {
  const bool has_maps = std::ranges::any_of(records, &TileRecord::has_normal_map);
  const auto magic = std::as_bytes(std::span(kIndexMagic));
  std::vector<std::byte> bytes(magic.begin(), magic.end());
  bytes.reserve(kIndexHeaderBytes + records.size() * kRecordBytes);
  append_little(bytes, has_maps ? kIndexVersion : kNoMapsIndexVersion);
  append_little(bytes, static_cast<std::uint32_t>(kRecordBytes));
  append_little(bytes, std::uint64_t{records.size()});
  append_little(bytes, std::uint64_t{0});
  for (const TileRecord& record : records)
    append_record(bytes, record);
  store_little(index_checksum(bytes), bytes.data() + kCheckedHeaderBytes);
  return bytes;
}

std::vector<TileRecord> decode_index(std::span<const std::byte> bytes, const Tree& tree,
                                     const std::string& name) {
  return IndexReader(bytes, tree, name).read();
}

const TileRecord& record_of(std::span<const TileRecord> records, NodeId node) {
  const auto found =
      std::lower_bound(records.begin(), records.end(), node,
                       [](const TileRecord& record, NodeId key) { return record.node < key; });
  assert(found != records.end() && found->node == node);
  return *found;
}

}  // namespace meshhier::storage
