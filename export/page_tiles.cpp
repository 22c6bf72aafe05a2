#include "export/page_tiles.h"

#include "export/base64.h"
#include "hierarchy/rounded_tile.h"
#include "partition/compactness.h"
#include "storage/format/build_name.h"
#include "storage/format/gzip.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/format/level_summary.h"
#include "storage/io/hash.h"
#include "storage/io/sealed_file.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

#include <fmt/format.h>

namespace meshhier::exporting {
namespace {

/// Records of the index that the viewer fetches at once (viewer/src/hierarchy/tile_index.ts).
constexpr std::uint64_t kPageRecords = 545;
/// The largest file of a hierarchy: the largest length that a GLB can have.
constexpr std::uint64_t kMostFile = std::numeric_limits<std::uint32_t>::max();

/// Returns a lattice for all levels, over the boxes of all tiles, which coarse ones may leave a
/// little. Nothing if the positions lie on one already that is no finer.
std::optional<Lattice> short_lattice(const storage::HierarchyReader& reader) {
  const auto& quantization = reader.manifest().quantization;
  if (quantization && quantization->lattice.is_short())
    return std::nullopt;
  Bounds bounds;
  for (const TileRecord& record : reader.records())
    bounds.add(record.bounds);
  return make_lattice(bounds, Lattice::kShortBits);
}

storage::TileFormat packed_format(const storage::HierarchyReader& reader, PagePacking packing) {
  storage::TileFormat format = reader.tile_format();
  if (packing == PagePacking::as_stored)
    return format;
  format.compression = storage::Compression::meshopt;  // entries are in gzip anyway
  format.objects.reset();                              // the viewer reads the hierarchy's table
  if (packing == PagePacking::rounded) {
    if (const auto lattice = short_lattice(reader))
      format.lattice = lattice;
  }
  return format;
}

std::vector<std::byte> gzipped(std::span<const std::byte> bytes) {
  std::vector<std::byte> smaller = storage::gzip(bytes);
  return smaller.size() < bytes.size() ? smaller
                                       : std::vector<std::byte>(bytes.begin(), bytes.end());
}

/// Bytes of the index up to the page of records that has this one.
std::uint64_t index_bytes_with(const storage::HierarchyReader& reader, std::uint64_t record) {
  const std::uint64_t records = (record / kPageRecords + 1) * kPageRecords;
  return std::min(storage::index_bytes(records), reader.manifest().index_bytes);
}

/// Returns the most bytes that the index's entry takes.
std::uint64_t index_entry_bytes(const storage::HierarchyReader& reader, std::uint64_t record) {
  constexpr std::uint64_t kName = 100;
  return base64_size(index_bytes_with(reader, record)) + kName;
}

/// A tile that may be refined, the one with the largest error first.
struct Coarse {
  float error = 0;
  NodeId node;
  friend bool operator<(const Coarse& a, const Coarse& b) {
    return a.error != b.error ? a.error < b.error : b.node < a.node;
  }
};

/// Takes tiles as long as they fit.
class Choosing {
 public:
  Choosing(const PagePacker& packer, std::uint64_t room) : packer_(packer), room_(room) {}

  /// All or none of them; false: they do not fit.
  bool take(std::span<const NodeId> tiles) {
    PageChoice next{{}, choice_.bytes, choice_.last_record, 0, choice_.rounding, 0};
    for (const NodeId tile : tiles) {
      const PackedTile packed = packer_.pack(tile);
      next.bytes += packed.entry.size();
      next.rounding = std::max(next.rounding, packed.rounding);
      next.last_record = std::max(next.last_record, record_number(packer_.reader(), tile));
    }
    const std::uint64_t needed = next.bytes + index_entry_bytes(packer_.reader(), next.last_record);
    if (choice_.tiles.empty())
      choice_.least = needed;
    if (needed > room_)
      return false;
    choice_.bytes = next.bytes;
    choice_.last_record = next.last_record;
    choice_.rounding = next.rounding;
    choice_.tiles.insert(choice_.tiles.end(), tiles.begin(), tiles.end());
    for (const NodeId tile : tiles) {
      if (!packer_.reader().tree().is_partition(tile))
        coarse_.push({packer_.reader().record(tile).error, tile});
    }
    return true;
  }

  /// Takes the tiles below the coarsest one; returns false if nothing is coarse, or they do not
  /// fit.
  bool refine() {
    if (coarse_.empty())
      return false;
    const Coarse next = coarse_.top();
    const Tree& tree = packer_.reader().tree();
    std::vector<NodeId> below;
    const Tree::Children children = tree.children(next.node);
    for (const NodeId child : children.span())
      below.push_back(tree.tile_node(child));
    coarse_.pop();
    if (take(below))
      return true;
    coarse_.push(next);
    return false;
  }

  PageChoice done() && {
    choice_.error = coarse_.empty() ? 0 : coarse_.top().error;
    return std::move(choice_);
  }

 private:
  const PagePacker& packer_;
  std::uint64_t room_;
  PageChoice choice_;
  std::priority_queue<Coarse> coarse_;
};

}  // namespace

std::string page_entry(const std::filesystem::path& name, std::span<const std::byte> bytes) {
  return fmt::format(",\n\"{}\":\"{}\"", name.generic_string(), base64(gzipped(bytes)));
}

PagePacker::PagePacker(storage::FileSystem& files, const storage::HierarchyReader& reader,
                       PagePacking packing)
    : files_(files), reader_(reader), packing_(packing), format_(packed_format(reader, packing)) {}

PackedTile PagePacker::pack(NodeId tile) const {
  PackedTile packed{{}, reader_.record(tile), 0};
  const auto name = storage::tile_path({}, tile);
  if (packing_ == PagePacking::as_stored) {
    const auto bytes = storage::of_one_build(files_, reader_.directory(), reader_.manifest(), [&] {
      return storage::read_sealed(files_, storage::tile_path(reader_.directory(), tile),
                                  {packed.record.file_bytes, packed.record.checksum}, kMostFile);
    });
    packed.entry = page_entry(name, bytes);
    return packed;
  }
  PublishedTile published = reader_.read_tile(tile);
  if (format_.lattice) {
    packed.rounding = round_to(*format_.lattice, published.mesh);
    packed.record.bounds = bounds_of(published.mesh.vertices.positions);
    if (reader_.tree().is_partition(tile))
      packed.record.compactness = partition::published_compactness(published.mesh);
  }
  const auto bytes = storage::encode_tile(published, reader_.tree(), format_);
  packed.record.file_bytes = bytes.size();
  packed.record.checksum = storage::checksum(bytes);
  packed.entry = page_entry(name, bytes);
  return packed;
}

double PagePacker::most_rounding() const {
  const bool moves = format_.lattice != reader_.tile_format().lattice;
  return moves ? format_.lattice->step * std::sqrt(3.0) / 2 : 0;
}

storage::Manifest PagePacker::manifest(std::span<const TileRecord> records, double rounding,
                                       bool has_words, std::span<const std::byte> index) const {
  storage::Manifest manifest = reader_.manifest();
  manifest.compression = format_.compression;
  if (manifest.objects)
    manifest.objects->are_in_tiles = format_.objects.has_value();
  if (manifest.objects && manifest.objects->words && !has_words) {
    manifest.total_bytes -= manifest.objects->words->bytes;
    manifest.objects->words.reset();
  }
  manifest.config["storage"]["compression"] = storage::row_of(format_.compression).name;
  if (format_.lattice) {
    const double before = manifest.quantization ? manifest.quantization->worst_rounding : 0;
    manifest.quantization = storage::Quantization{*format_.lattice, before + rounding};
    manifest.config["storage"]["positions"] = {{"bits", format_.lattice->bits}};
  }
  manifest.index_bytes = index.size();
  manifest.index_checksum = storage::checksum(index);
  manifest.levels = nlohmann::ordered_json::array();
  for (const storage::LevelSummary& level : storage::summarize_levels(reader_.tree(), records))
    manifest.levels.push_back(storage::to_json(level));
  for (const TileRecord& record : reader_.records())
    manifest.total_bytes -= record.file_bytes;
  for (const TileRecord& record : records)
    manifest.total_bytes += record.file_bytes;
  return manifest;
}

std::string PagePacker::account(std::vector<TileRecord> records, std::uint64_t last_record,
                                double rounding, bool has_words) const {
  const auto entry = [&](const std::filesystem::path& path, std::vector<std::byte> bytes) {
    if (path == storage::index_path({}))
      bytes.resize(index_bytes_with(reader_, last_record));
    return page_entry(path, bytes);
  };
  if (packing_ == PagePacking::as_stored) {
    std::string entries;
    for (const auto& path : {storage::index_path({}), storage::manifest_path({})})
      entries += entry(path, storage::read_file(files_, reader_.directory() / path, kMostFile));
    return entries;
  }
  const int depth = raw(reader_.tree().depth());
  for (TileRecord& record : records) {
    if (rounding > 0)
      record.bound = bound_with_rounding(record.bound, rounding, depth - raw(record.node.level));
  }
  const std::vector<std::byte> index = storage::encode_index(records);
  const std::string text = storage::to_json_text(manifest(records, rounding, has_words, index));
  const auto bytes = std::as_bytes(std::span(text));
  return entry(storage::index_path({}), index) +
         entry(storage::manifest_path({}), {bytes.begin(), bytes.end()});
}

std::uint64_t record_number(const storage::HierarchyReader& reader, NodeId tile) {
  const auto& records = reader.records();
  return static_cast<std::uint64_t>(&storage::record_of(records, tile) - records.data());
}

PageChoice choose_tiles(const PagePacker& packer, std::uint64_t room, execution::Progress& progress,
                        const execution::CancelToken& cancel) {
  Choosing choosing(packer, room);
  const NodeId root = packer.reader().tree().root();
  bool fits = choosing.take({&root, 1});
  while (fits) {
    cancel.check();
    progress.advance(1);
    fits = choosing.refine();
  }
  return std::move(choosing).done();
}

std::uint64_t expected_page_bytes(const PagePacker& packer, const PageChoice& choice,
                                  const execution::CancelToken& cancel) {
  constexpr std::size_t kSample = 16;
  constexpr double kMargin = 1.05;
  const storage::HierarchyReader& reader = packer.reader();
  std::vector<NodeId> chosen = choice.tiles;
  std::ranges::sort(chosen);
  std::vector<TileRecord> others;
  for (const TileRecord& record : reader.records()) {
    if (!std::ranges::binary_search(chosen, record.node))
      others.push_back(record);
  }
  double stored = 0, sampled = 0, entries = 0;
  for (const TileRecord& record : others)
    stored += static_cast<double>(record.file_bytes);
  const std::size_t count = std::min(kSample, others.size());
  for (std::size_t i = 0; i < count; ++i) {
    cancel.check();
    const TileRecord& record = others[(2 * i + 1) * others.size() / (2 * count)];
    sampled += static_cast<double>(record.file_bytes);
    entries += static_cast<double>(packer.pack(record.node).entry.size());
  }
  const double more = sampled > 0 ? stored * entries / sampled * kMargin : 0;
  return choice.bytes + static_cast<std::uint64_t>(more) +
         index_entry_bytes(reader, reader.records().size() - 1);
}

}  // namespace meshhier::exporting
