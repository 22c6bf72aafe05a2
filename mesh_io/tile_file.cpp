#include "mesh_io/tile_file.h"

#include "base/error.h"
#include "mesh_io/gltf_json.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/part_of_file.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

// Headers of tiles, little endian, in words of 4 bytes:
//
//   b3dm  magic, version 1, bytes of the tile; bytes of the feature table's JSON and binary, of the
//         batch table's JSON and binary; these four; the glTF
//   cmpt  magic, version 1, bytes of the tile, count of tiles; the tiles
constexpr std::uint64_t kTileHeaderBytes = 12;
constexpr std::uint64_t kBatchedHeaderBytes = 28;
constexpr std::uint64_t kCompositeHeaderBytes = 16;
constexpr int kDeepestComposite = 8;
/// The most tiles in a file; the least takes 12 bytes of it, and more to be remembered.
constexpr std::uint64_t kMostComposed = 65536;
/// The most tiles in a file in gzip, which is unpacked anew to reach each.
constexpr std::uint64_t kMostPackedComposed = 256;

/// A range of the file that is a tile.
struct Extent {
  std::uint64_t begin = 0, end = 0;
  std::uint64_t bytes() const { return end - begin; }
};

/// Bytes of the four parts between the header and the glTF of a b3dm.
struct BatchedParts {
  std::uint64_t header = kBatchedHeaderBytes;
  std::array<std::uint64_t, 4> bytes{};
  std::uint64_t features = UINT64_MAX;  ///< as old headers say it; others have a feature table
  std::uint64_t before_gltf() const { return header + bytes[0] + bytes[1] + bytes[2] + bytes[3]; }
};

class TileFileReader {
 public:
  TileFileReader(const storage::File& file, std::uint64_t most_bytes, std::uint64_t most_tiles)
      : file_(file), most_bytes_(most_bytes), most_tiles_(most_tiles) {}

  TileFile read() {
    read_tile({0, file_.size()}, 0);
    return std::move(found_);
  }

 private:
  void read_tile(Extent tile, int depth) {
    if (++tiles_ > most_tiles_)
      fail_file(file_.path(), fmt::format("holds more than {} tiles", most_tiles_));
    const std::string magic = text(tile.begin, std::min<std::uint64_t>(4, tile.bytes()));
    if (magic == "b3dm") {
      read_batched(sized(tile));
    } else if (magic == "cmpt") {
      read_composite(sized(tile), depth);
    } else if (magic == "i3dm") {
      ++found_.instanced;
    } else if (magic == "pnts") {
      ++found_.points;
    } else if (magic == "vctr" || magic == "geom") {  // of drafts that Cesium reads
      ++found_.vectors;
    } else if (magic == "glTF") {
      add_mesh(MeshKind::glb, tile);
    } else {
      read_json(tile);
    }
  }

  void read_json(Extent tile) {
    const auto format = tile.begin == 0 ? find_format(file_) : std::nullopt;
    if (format && format->kind == MeshKind::tileset)
      found_.is_tileset = true;
    else if (format && format->kind == MeshKind::gltf)
      add_mesh(MeshKind::gltf, tile);
    else
      fail_at_byte(file_.path(), tile.begin,
                   "expected a tile of 3D Tiles (b3dm, cmpt, glTF or GLB) or a tileset, found " +
                       in_quotes(text(tile.begin, std::min<std::uint64_t>(16, tile.bytes()))));
  }

  void add_mesh(MeshKind kind, Extent gltf, Vec3d centre = {}, const BatchTablePlace& batch = {}) {
    const std::shared_ptr<const storage::File> file(std::shared_ptr<void>(), &file_);
    found_.meshes.push_back(
        {kind, gltf.begin, gltf.bytes(), centre, batch,
         row_of(kind).outline(*mesh_io::part_of(file, gltf.begin, gltf.bytes()))});
  }

  /// The tile as long as it says.
  Extent sized(Extent tile) const {
    if (tile.bytes() < kTileHeaderBytes)
      fail_short(tile);
    const std::uint32_t version = word(tile.begin, 1);
    if (version != 1)
      fail_at_byte(file_.path(), tile.begin,
                   fmt::format("the tile is of version {}, expected 1", version));
    const std::uint64_t bytes = word(tile.begin, 2);
    if (bytes > tile.bytes() || bytes < kTileHeaderBytes) {
      fail_at_byte(file_.path(), tile.begin,
                   fmt::format("the tile has {} bytes as it says, and {} follow (truncated?)",
                               bytes, tile.bytes()));
    }
    return {tile.begin, tile.begin + bytes};
  }

  [[noreturn]] void fail_short(Extent tile) const {
    fail_at_byte(file_.path(), tile.begin, "the tile ends within its header (truncated?)");
  }

  void read_batched(Extent tile) {
    if (tile.bytes() < kBatchedHeaderBytes)
      fail_short(tile);
    const BatchedParts parts = batched_parts(tile);
    if (parts.before_gltf() > tile.bytes()) {
      fail_at_byte(file_.path(), tile.begin,
                   "the tables of the b3dm reach beyond its end (truncated?)");
    }
    const std::uint64_t gltf = tile.begin + parts.before_gltf();
    const FeatureFacts features = features_of(tile.begin, parts);
    const BatchTablePlace batch{gltf - parts.bytes[2] - parts.bytes[3], parts.bytes[2],
                                parts.bytes[3], features.count};
    add_mesh(MeshKind::b3dm, {gltf, tile.end}, features.centre, batch);
  }

  /// Before 3D Tiles 1.0 headers were shorter: their words are followed by the JSON of the batch
  /// table or by the glTF, whose first letters no length can be.
  BatchedParts batched_parts(Extent tile) const {
    const auto is_text = [&](std::size_t index) {
      const std::string at = text(tile.begin + 4 * index, 4);
      return at == "glTF" || (at.starts_with("{\"") && at[2] >= ' ' && at[3] >= ' ');
    };
    std::array<std::uint64_t, 4> words{};
    for (std::size_t i = 0; i < words.size(); ++i)
      words[i] = word(tile.begin, 3 + i);
    if (is_text(5))  // count of batches, bytes of the table
      return {20, {0, 0, words[1], 0}, words[0]};
    if (is_text(6))  // bytes of the table's JSON and binary, count of batches
      return {24, {0, 0, words[0], words[1]}, words[2]};
    return {kBatchedHeaderBytes, words};
  }

  /// What a feature table says.
  struct FeatureFacts {
    std::uint64_t count = UINT64_MAX;
    Vec3d centre{};
  };

  FeatureFacts features_of(std::uint64_t tile, const BatchedParts& parts) const {
    if (parts.bytes[0] == 0)
      return {parts.features, {}};
    if (parts.bytes[0] > most_bytes_)
      throw Error(ErrorCode::budget,
                  fmt::format("{}: the feature table of the tile takes {} bytes, more than there "
                              "are; give a larger memory_budget",
                              file_.path().string(), parts.bytes[0]));
    const std::uint64_t begin = tile + parts.header;
    std::string table_text = text(begin, parts.bytes[0]);
    table_text.erase(table_text.find_last_not_of('\0') + 1);  // some programs pad it with zeros
    const auto json = parse_gltf_json(std::move(table_text), file_.path(), most_bytes_);
    const GltfObject table(json, file_.path(), "feature table");
    return {table.count("BATCH_LENGTH", UINT32_MAX).value_or(UINT64_MAX),
            centre_of(table, begin + parts.bytes[0], parts.bytes[1])};
  }

  /// `binary`: where the binary part begins, which has so many bytes.
  Vec3d centre_of(const GltfObject& table, std::uint64_t binary, std::uint64_t binary_bytes) const {
    const char* key = "RTC_CENTER";
    if (!table.has(key))
      return {};
    if (!table.has_object(key)) {
      const auto numbers = table.numbers(key, 3);
      return {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    }
    constexpr std::uint64_t kBytes = 12;
    if (binary_bytes < kBytes)
      table.fail("has its RTC_CENTER in a binary part that has no room for it");
    const std::uint64_t at =
        table.require_object(key).require_count("byteOffset", binary_bytes - kBytes);
    std::array<std::byte, kBytes> bytes{};
    file_.read_exact(binary + at, bytes);
    const auto number = [&](std::size_t i) {
      return double{storage::load_little<float>(bytes.data() + 4 * i)};
    };
    return {number(0), number(1), number(2)};
  }

  void read_composite(Extent tile, int depth) {
    if (tile.bytes() < kCompositeHeaderBytes)
      fail_short(tile);
    if (depth == kDeepestComposite)
      fail_at_byte(file_.path(), tile.begin,
                   fmt::format("tiles lie in each other deeper than {} levels", depth));
    const std::uint32_t count = word(tile.begin, 3);
    std::uint64_t at = tile.begin + kCompositeHeaderBytes;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (tile.end - at < kTileHeaderBytes)
        fail_at_byte(
            file_.path(), at,
            fmt::format("the composite ends behind {} of {} tiles (truncated?)", i, count));
      const std::uint64_t bytes = word(at, 2);  // a GLB has its length there, too
      if (bytes < kTileHeaderBytes || bytes > tile.end - at)
        fail_at_byte(file_.path(), at,
                     fmt::format("a tile of {} bytes begins, but the composite has {} more", bytes,
                                 tile.end - at));
      read_tile({at, at + bytes}, depth + 1);
      at += bytes;
    }
  }

  std::uint32_t word(std::uint64_t tile, std::size_t index) const {
    std::array<std::byte, 4> bytes{};
    file_.read_exact(tile + 4 * index, bytes);
    return storage::load_little<std::uint32_t>(bytes.data());
  }

  std::string text(std::uint64_t offset, std::uint64_t bytes) const {
    std::string text(static_cast<std::size_t>(bytes), '\0');
    file_.read_exact(offset, std::as_writable_bytes(std::span(text)));
    return text;
  }

  const storage::File& file_;
  std::uint64_t most_bytes_;
  std::uint64_t most_tiles_;
  std::uint64_t tiles_ = 0;
  TileFile found_;
};

}  // namespace

TileFile read_tile_file(const storage::File& file, std::uint64_t most_bytes) {
  if (!is_gzip(file))
    return TileFileReader(file, most_bytes, kMostComposed).read();
  const auto content = unpacked(file);
  TileFile found = TileFileReader(*content, most_bytes, kMostPackedComposed).read();
  found.is_packed = true;
  return found;
}

}  // namespace meshhier::mesh_io
