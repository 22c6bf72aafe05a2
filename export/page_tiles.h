// The tiles of a page: how they are packed, and which of them fit.
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

/// What a page shows is within the error of its coarsest tile of the original, so a rounding that
/// is smaller costs nothing that could be seen.
enum class PagePacking {
  as_stored,  ///< the very files, in gzip: others of the same hierarchy fit to them
  exact,      ///< by meshopt, then gzip; nothing is lost
  rounded     ///< the same, on a lattice of 16 bits
};

/// A tile as it stands in a page.
struct PackedTile {
  std::string entry;    ///< page_entry() of its file
  TileRecord record;    ///< of that file
  double rounding = 0;  ///< how far a vertex went, at most; input units
};

/// A file in the page's JSON: a comma, its name and its bytes, in gzip where that is smaller, in
/// base64.
std::string page_entry(const std::filesystem::path& name, std::span<const std::byte> bytes);

/// Packs tiles. Deterministic; holds one tile. All must outlive it.
class PagePacker {
 public:
  PagePacker(storage::FileSystem& files, const storage::HierarchyReader& reader,
             PagePacking packing);

  PagePacking packing() const { return packing_; }
  const storage::HierarchyReader& reader() const { return reader_; }
  /// Throws Error(io), Error(corrupt).
  PackedTile pack(NodeId tile) const;
  /// No vertex goes farther, input units; 0 unless tiles are rounded.
  double most_rounding() const;
  /// The entries of the index, up to the page of records that has `last_record`, and of the
  /// manifest. `records`: all of the index, those of packed tiles as pack() told them; `rounding`:
  /// how far a vertex of them went, at most.
  std::string account(std::vector<TileRecord> records, std::uint64_t last_record,
                      double rounding) const;

 private:
  storage::Manifest manifest(std::span<const TileRecord> records, double rounding,
                             std::span<const std::byte> index) const;

  storage::FileSystem& files_;
  const storage::HierarchyReader& reader_;
  PagePacking packing_;
  storage::TileFormat format_;
};

/// Tiles that fit a room.
struct PageChoice {
  std::vector<NodeId> tiles;      ///< none: not even the root fits
  std::uint64_t bytes = 0;        ///< of their entries
  std::uint64_t last_record = 0;  ///< of the index that these tiles need
  float error = 0;                ///< the largest of what is not refined, input units
  double rounding = 0;            ///< the largest of these tiles
  std::uint64_t least = 0;        ///< what the root alone needs, with its part of the index
};

/// Where the index has the record of a tile.
std::uint64_t record_number(const storage::HierarchyReader& reader, NodeId tile);

/// The root, then always both children of the node with the largest error, as long as they fit with
/// the index.
PageChoice choose_tiles(const PagePacker& packer, std::uint64_t room, execution::Progress& progress,
                        const execution::CancelToken& cancel);

/// What the entries of all tiles and of the index take, about: the tiles that are not chosen by a
/// sample of them.
std::uint64_t expected_page_bytes(const PagePacker& packer, const PageChoice& choice,
                                  const execution::CancelToken& cancel);

}  // namespace meshhier::exporting
