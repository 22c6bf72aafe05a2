// The parts of verify and what they share. For verify*.cpp only.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/node_cache.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/io/spool.h"
#include "verify/border_pairs.h"
#include "verify/copy_claims.h"
#include "verify/verify.h"

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::verifying {

/// Collects problems up to a limit, counts the rest.
class ProblemList {
 public:
  /// What a person reads before looking at the cause; a broken disk may bring millions.
  static constexpr std::size_t kLimit = 100;

  void add(std::string problem) {
    if (problems_.size() < kLimit)
      problems_.push_back(std::move(problem));
    ++count_;
  }
  std::uint64_t count() const { return count_; }
  /// The problems; if there were more, a last line says how many.
  std::vector<std::string> take();

 private:
  std::vector<std::string> problems_;
  std::uint64_t count_ = 0;
};

/// Tiles by node, read at most once while the cache lasts. A tile that cannot be read is a problem,
/// told once.
class TileStore {
 public:
  TileStore(const storage::HierarchyReader& reader, std::uint64_t cache_bytes,
            ProblemList& problems);

  /// The tile that stands for the node; null if it cannot be read.
  std::shared_ptr<const PublishedTile> find(NodeId node);
  std::size_t unreadable_count() const { return unreadable_.size(); }

 private:
  const Tree& tree_;
  ProblemList& problems_;
  exporting::NodeCache<PublishedTile> cache_;
  std::set<NodeId> unreadable_;
};

/// What every part works with. The memory budget is shared out: a quarter to the tiles, an eighth
/// to the pool of the scratch file, at most half to the sorts and tables of the part that runs.
struct VerifyJob {
  storage::FileSystem& files;
  const storage::HierarchyReader& reader;
  const VerifyOptions& options;
  storage::ScratchFile& scratch;
  TileStore& tiles;
  ProblemList& problems;
  std::vector<std::string>& checks;
  execution::Progress& progress;
  const execution::CancelToken& cancel;

  const Tree& tree() const { return reader.tree(); }
};

/// No file missing, none extra, no link; outline readable.
void verify_files(const VerifyJob& job);

/// The preview, if there is one, is the picture that the manifest tells of.
void verify_preview(const VerifyJob& job);

/// Every value of the manifest that follows from the rest is what it should be, and nothing else is
/// there.
void verify_manifest(const VerifyJob& job);
/// What it says of the outline.
void verify_outline(const VerifyJob& job, const Outline& outline);
/// What all partitions together hold, beside places and triangles.
struct PartitionTotals {
  std::uint64_t copies = 0;
  std::uint64_t unreferenced = 0;  ///< vertices that are corners of no triangle
};
/// What it says of the input's vertices.
void verify_vertex_counts(const VerifyJob& job, const PartitionTotals& found);

/// Every tile by itself, with its children, and with its neighbours.
void verify_tiles(const VerifyJob& job);

/// All that a tile says without its neighbours: verify_tile(), verify_texture(), verify_image().
void verify_alone(const VerifyJob& job, const TileRecord& record, const PublishedTile& tile);

/// Counts, bounds, errors, order, boundary, copies of one tile against its record and its parent's.
void verify_tile(const VerifyJob& job, const TileRecord& record, const PublishedTile& tile);

/// Splits and picture of a tile of a textured hierarchy.
void verify_texture(const VerifyJob& job, const PublishedTile& tile);

/// `job` must outlive it.
ParentMaps make_parent_maps(const VerifyJob& job);

/// The tiles that may have something in options.region, by themselves, with their children and with
/// each other.
void verify_piece(const VerifyJob& job);

/// Tells what two neighbouring nodes of a level say differently of each other: ghosts, chains,
/// border lists. False if a tile cannot be read.
bool compare_neighbours(const VerifyJob& job, NodeId a, NodeId b);

/// Tells what two neighbouring nodes of a level, early ones too, say differently of each other:
/// ghosts, chains, border lists.
void explain_difference(const VerifyJob& job, NodeId a, NodeId b);

/// Tells it.
void tell_wrong_copies(const VerifyJob& job, const WrongCopies& wrong);

/// That a simplified tile is exactly the image of its children under their parent maps.
void verify_image(const VerifyJob& job, const PublishedTile& tile);

/// No crack in the cut of all partitions that the input has not, nor in random cuts.
void verify_seams(const VerifyJob& job);

/// The partitions are exactly the input. Requires job.options.input.
void verify_input(const VerifyJob& job);

}  // namespace meshhier::verifying
