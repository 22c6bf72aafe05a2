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
  /// The most problems that are listed: a person reads no more before looking at the cause, and a
  /// broken disk may bring millions.
  static constexpr std::size_t kLimit = 100;

  void add(std::string problem) {
    if (problems_.size() < kLimit)
      problems_.push_back(std::move(problem));
    ++count_;
  }
  std::uint64_t count() const { return count_; }
  /// Returns the problems; if there were more, a last line says how many.
  std::vector<std::string> take();

 private:
  std::vector<std::string> problems_;
  std::uint64_t count_ = 0;
};

/// Keeps tiles by node; each is read at most once while the cache lasts. A tile that cannot be read
/// is a problem, told once.
class TileStore {
 public:
  TileStore(const storage::HierarchyReader& reader, std::uint64_t cache_bytes,
            ProblemList& problems);

  /// Returns the tile that stands for the node; null if it cannot be read.
  std::shared_ptr<const PublishedTile> find(NodeId node);
  std::size_t unreadable_count() const { return unreadable_.size(); }

 private:
  const Tree& tree_;
  ProblemList& problems_;
  exporting::NodeCache<PublishedTile> cache_;
  std::set<NodeId> unreadable_;
};

/// The means that every part works with. Parts add problems and checks; they throw if the work
/// cannot go on: Error(io), Error(interrupted), and verify_seams() also Error(corrupt). The memory
/// budget is shared out: a quarter to the tiles, an eighth to the pool of the scratch file, at most
/// half to the sorts and tables of the part that runs.
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

/// Checks that no file is missing, none is extra, none is a link; and that the outline is readable.
void verify_files(const VerifyJob& job);

/// Checks that the preview, if there is one, is the picture that the manifest tells of.
void verify_preview(const VerifyJob& job);

/// Checks that every value of the manifest that follows from the rest is right, and nothing else is
/// there.
void verify_manifest(const VerifyJob& job);
/// Checks the manifest's values of the outline.
void verify_outline(const VerifyJob& job, const Outline& outline);
/// Totals of all partitions, besides places and triangles.
struct PartitionTotals {
  std::uint64_t copies = 0;
  std::uint64_t unreferenced = 0;  ///< vertices that are corners of no triangle
};
/// Checks the manifest's counts of the input's vertices.
void verify_vertex_counts(const VerifyJob& job, const PartitionTotals& found);

/// Checks every tile by itself, with its children, and with its neighbours.
void verify_tiles(const VerifyJob& job);

/// Checks all of a tile that does not depend on neighbours: verify_tile(), verify_texture(),
/// verify_image().
void verify_alone(const VerifyJob& job, const TileRecord& record, const PublishedTile& tile);

/// Checks counts, bounds, errors, order, boundary and copies of one tile against its record and its
/// parent's.
void verify_tile(const VerifyJob& job, const TileRecord& record, const PublishedTile& tile);

/// Checks splits and picture of a tile of a textured hierarchy.
void verify_texture(const VerifyJob& job, const PublishedTile& tile);

/// Returns the cache of parent maps. `job` must outlive it.
ParentMaps make_parent_maps(const VerifyJob& job);

/// Checks the tiles that may have something in options.region, by themselves, with their children
/// and with each other.
void verify_piece(const VerifyJob& job);

/// Tells the differences between the claims of two neighbouring nodes of a level: ghosts, chains,
/// border lists. Returns false if a tile cannot be read.
bool compare_neighbours(const VerifyJob& job, NodeId a, NodeId b);

/// Does the same for nodes of which one or both may be early.
void explain_difference(const VerifyJob& job, NodeId a, NodeId b);

/// Tells the problem of wrong copies.
void tell_wrong_copies(const VerifyJob& job, const WrongCopies& wrong);

/// Checks that a simplified tile is exactly the image of its children under their parent maps.
void verify_image(const VerifyJob& job, const PublishedTile& tile);

/// Checks that the cut of all partitions, and random cuts, have no crack that the input has not.
void verify_seams(const VerifyJob& job);

/// Checks that the partitions are exactly the input. Requires job.options.input.
void verify_input(const VerifyJob& job);

}  // namespace meshhier::verifying
