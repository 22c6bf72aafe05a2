// The tiles of a page: packs them, and chooses those that fit.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "hierarchy/ids.h"
#include "hierarchy/lattice.h"
#include "hierarchy/published.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/manifest.h"
#include "storage/format/tile_glb.h"
#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace meshhier::exporting {

/// The packing of tiles. A page is within the error of its coarsest tile of the original, so a
/// rounding that is smaller costs nothing that could be seen.
enum class PagePacking {
  as_stored,  ///< the very files, in gzip: others of the same hierarchy fit to them
  exact,      ///< by meshopt, then gzip; nothing is lost
  rounded     ///< as `exact`, with positions on a lattice of 16 bits
};

/// A tile as it stands in a page.
struct PackedTile {
  std::string entry;    ///< page_entry() of its file
  TileRecord record;    ///< record of that file
  double rounding = 0;  ///< the farthest that a vertex moved, input units
};

/// Returns a file's entry in the page's JSON: a comma, its name and its bytes, in gzip where that
/// is smaller, in base64.
std::string page_entry(const std::filesystem::path& name, std::span<const std::byte> bytes);

/// Packs tiles. Deterministic; holds one tile. All must outlive it.
class PagePacker {
 public:
  PagePacker(storage::FileSystem& files, const storage::HierarchyReader& reader,
             PagePacking packing);

  PagePacking packing() const { return packing_; }
  const storage::HierarchyReader& reader() const { return reader_; }
  /// Reads and packs a tile. Throws Error(io), Error(corrupt).
  PackedTile pack(NodeId tile) const;
  /// Returns the farthest that a vertex may move, in input units; 0 unless tiles are rounded.
  double most_rounding() const;
  /// Returns the entries of the index, up to the page of records that has `last_record`, and of the
  /// manifest. `records`: all of the index, those of packed tiles as pack() returned them;
  /// `rounding`: the largest of these tiles. `has_words`: the page has the words of
  /// objects' names; if not, the manifest tells of none, but for pages with a link.
  std::string account(std::vector<TileRecord> records, std::uint64_t last_record, double rounding,
                      bool has_words) const;

 private:
  storage::Manifest manifest(std::span<const TileRecord> records, double rounding, bool has_words,
                             std::span<const std::byte> index) const;

  storage::FileSystem& files_;
  const storage::HierarchyReader& reader_;
  PagePacking packing_;
  storage::TileFormat format_;
};

/// Tiles that fit a room.
struct PageChoice {
  std::vector<NodeId> tiles;      ///< none: not even the root fits
  std::uint64_t bytes = 0;        ///< bytes of their entries
  std::uint64_t last_record = 0;  ///< last record of the index that these tiles need
  float error = 0;                ///< the largest error of tiles that are not refined, input units
  double rounding = 0;            ///< the largest of these tiles
  std::uint64_t least = 0;        ///< bytes that the root alone needs, with its part of the index
};

/// Returns the number of a tile's record in the index.
std::uint64_t record_number(const storage::HierarchyReader& reader, NodeId tile);

/// Chooses the root, then always both children of the node with the largest error, as long as they
/// fit into `room` bytes with the index.
PageChoice choose_tiles(const PagePacker& packer, std::uint64_t room, execution::Progress& progress,
                        const execution::CancelToken& cancel);

/// Returns the bytes of the entries of all tiles and of the index, about: it packs a sample of the
/// tiles that are not chosen.
std::uint64_t expected_page_bytes(const PagePacker& packer, const PageChoice& choice,
                                  const execution::CancelToken& cancel);

}  // namespace meshhier::exporting
