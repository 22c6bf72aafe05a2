// The journal of a build says on disk what is done: a build that is stopped, however, goes on from
// there.
//
// A build makes these entries, in this order:
//
//   build      all that decides the result: input, config, tree, version
//   partition  where a chunk's spools are, when all triangles are distributed; of a slice of the
//              input, where its part of them is
//   ingest     what was learnt of the input; with it the stages up to partition are done, unless
//              slices follow: then the last one counts
//   image      a decoded picture of a textured mesh
//   leaves     a chunk's partitions
//   simplify   a simplified tile, the maps to it, and how far its children had moved
//   root       how far the root had moved, and its normals
//   texture    a tile's picture
//   publish    a tile's file
//   complete   all files of the hierarchy; the scratch files are not needed any more
//   took       of a task of a build on many machines: its time; says nothing of the work
//
// Whatever an entry names is checked, by checksum, before it is believed. The stages before
// `leaves` are one step: they take a twentieth of a build. `outline` takes no time.
#pragma once

#include "execution/cancel.h"
#include "hierarchy/published.h"
#include "images/image_store.h"
#include "images/material_list.h"
#include "import/input_record.h"
#include "pipeline/tiles/bound_chain.h"
#include "pipeline/tiles/chunks.h"
#include "pipeline/tiles/forest.h"
#include "pipeline/tiles/texture_store.h"
#include "storage/io/file.h"
#include "storage/io/journal.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// The facts on the input that are known when it is distributed.
struct DistributedSource {
  SourceSummary summary;
  Vec3d origin;
  images::MaterialList materials;  ///< empty unless the mesh is textured
  importing::InputRecord input;
};

/// Identifies the build that a journal belongs to.
struct BuildIdentity {
  nlohmann::json decides_result;  ///< an object
  std::int64_t input_times = 0;   ///< the input may be the same after it was touched
};

/// Returns "partition.vertices was 8192 and is 4096, ...": all that differs between two objects.
std::string differences(const nlohmann::json& was, const nlohmann::json& is);

/// The facts that an earlier build has noted of itself.
struct EarlierBuild {
  nlohmann::json decides_result;
  std::int64_t input_times = 0;
  SourceSummary source;
  images::MaterialList materials;
  importing::InputRecord input;
  bool is_whole = false;  ///< all of this is known
};
/// Takes the facts of one entry. Returns false if the entry is not understood.
bool add_entry(const nlohmann::json& entry, EarlierBuild& build);
/// Reads the facts from the journal in the directory `work`; returns nothing if there is none, or
/// if the input was not read as a whole. Does not look whether anything else is there. Throws
/// Error(io).
std::optional<EarlierBuild> find_earlier_build(storage::FileSystem& files,
                                               const std::filesystem::path& work);

/// The things that a journal restores.
struct Workpieces {
  Forest& forest;
  Chunks& chunks;
  TextureStore* textures = nullptr;        ///< null if tiles have neither pictures nor normal maps
  images::ImageStore* pictures = nullptr;  ///< null if the mesh has none
};

/// A picture that could not be decoded, and why.
using BrokenImage = std::pair<std::uint32_t, std::string>;

/// The step of a tile whose index on its level is known.
using IndexedStep = std::pair<std::uint32_t, StepDeviation>;

/// A tile's file.
struct Published {
  TileRecord record;    ///< but for error and bound, which are known when all tiles are there
  double rounding = 0;  ///< the largest distance that a position went to the lattice, input units
};

/// Notes what is done and says what is. An entry counts only if what it names is on disk as it was
/// written, so a stage may be stopped at any moment and begun again: it asks has_...() and makes
/// the rest. Queries may come from several threads while nothing is noted; notes come one at a
/// time. All that it refers to must outlive it.
class BuildJournal {
 public:
  /// Opens the journal in the directory `work`, or begins one, and puts back into `pieces` all that
  /// is done; published tiles only if their files are whole. Reads all of that, to check it. Bytes
  /// that the journal moves count in `use`. Throws Error(other_work) if something is done
  /// towards another result, telling what differs; Error(io | interrupted).
  BuildJournal(storage::FileSystem& files, const std::filesystem::path& work,
               const BuildIdentity& identity, storage::ScratchUse& use, Workpieces pieces,
               const execution::CancelToken& cancel);

  /// Whether the earlier work can be gone on with: something is done, and the disk has kept it.
  bool is_sound() const { return is_sound_; }
  /// Whether the input has another time than when the journal was begun: then its checksum must
  /// show whether it is the same.
  bool input_was_touched() const { return input_was_touched_; }
  /// The chunks, simplified tiles, pictures and published files that were found done; steps() is
  /// how many there will be in all.
  std::uint64_t found() const { return found_; }
  std::uint64_t steps() const;

  /// Makes the journal of one of several processes that build together (pipeline/tasks): nothing is
  /// done at first, and `sink` gets the notes. `built`: the directory of the hierarchy to be.
  BuildJournal(storage::FileSystem& files, const std::filesystem::path& built,
               BuildIdentity identity, Workpieces pieces, std::unique_ptr<storage::EntrySink> sink,
               const execution::CancelToken& cancel);

  /// Takes an entry of another process, whose scratch files are mounted; the data is checked when
  /// it is used. Returns false if the entry does not belong to a build of this tree.
  bool take_sealed(const nlohmann::json& entry);
  /// Does the same with an entry `partition`, but takes only the copies of the chunk.
  bool take_sealed_copies(const nlohmann::json& entry);
  /// Puts back the pictures that entries named; false if the scratch file does not hold them.
  bool restore_pictures();

  const std::optional<DistributedSource>& source() const { return source_; }
  bool has_leaves(std::uint32_t chunk) const { return has_leaves_[chunk] != 0; }
  /// Vertices that no triangle uses, in all chunks whose leaves are done.
  std::uint64_t unreferenced_vertices() const { return unreferenced_; }
  bool has_tile(NodeId node) const { return has_tile_[raw(node.level)][node.index] != 0; }
  bool has_root() const { return has_root_; }
  /// Hands over the steps of a level's tiles that went into tiles which are done; none are left.
  std::vector<IndexedStep> take_steps(Level level);
  /// The broken ones among the pictures that were to be decoded.
  const std::vector<BrokenImage>& broken_images() const { return broken_images_; }
  bool has_texture(NodeId node) const { return has_texture_[raw(node.level)][node.index] != 0; }
  bool is_published(NodeId node) const { return published_.contains({node.level, node.index}); }
  /// Whether the file is there, and whole; reads it. Thread-safe.
  bool is_as_published(const TileRecord& record) const;
  /// Returns all tiles that are published, ascending.
  std::vector<Published> published() const;

  /// Whether all that is left to do is to give the hierarchy its name.
  bool is_complete() const { return is_complete_; }

  // Each notes what is done now, and requires that its data is in scratch files or in the tile's
  // file; one call at a time. Nothing is forced to the disk: an entry whose data was lost is not
  // believed later. Throws Error(io); note_source() and note_chunks() also Error(interrupted).
  void note_source(const DistributedSource& source);
  /// Notes the chunks alone, of a slice of the input.
  void note_chunks();
  /// `why`: empty unless the picture is broken.
  void note_image(const images::StoredImage& stored, const std::string& why);
  void note_leaves(std::uint32_t chunk, std::uint64_t unreferenced_vertices);
  /// `steps`: those of the tile's children, if they are simplified tiles.
  void note_tile(NodeId node, std::span<const IndexedStep> steps);
  /// `steps`: the root's, if it is a simplified tile.
  void note_root(std::span<const IndexedStep> steps);
  void note_texture(NodeId node);
  void note_published(const Published& tile);
  void note_complete();
  /// Forces the entries to the disk, not their data. Throws Error(io).
  void sync() { sink_->sync(); }

 private:
  using Entry = storage::EntrySink::Entry;
  void make_room();
  void look_ahead(const std::filesystem::path& path, storage::ScratchUse& use);
  bool take(const Entry& entry);
  bool take_chunk(const Entry& chunk);
  bool pass_over(const Entry& /*any*/) { return true; }
  bool take_source(const Entry& source);
  bool take_leaves(const Entry& leaves);
  bool take_image(const Entry& image);
  bool take_tile(const Entry& tile);
  bool take_root(const Entry& root);
  void add_steps(std::span<const IndexedStep> steps, Level level);
  bool take_texture(const Entry& texture);
  bool take_published(const Entry& published);
  bool can_make_all_leaves() const;
  bool can_make_all_textures();
  /// Returns the flag of a node that an entry names; null if there is no such node.
  char* flag_of(const Entry& node, std::vector<std::vector<char>>& flags) const;

  storage::FileSystem& files_;
  std::filesystem::path built_;
  BuildIdentity identity_;
  Forest& forest_;
  Chunks& chunks_;
  TextureStore* textures_;
  images::ImageStore* pictures_;
  const execution::CancelToken& cancel_;
  std::optional<DistributedSource> source_;
  std::vector<char> has_leaves_;
  std::vector<std::vector<char>> has_tile_, has_texture_;
  std::vector<images::StoredImage> images_;
  std::vector<BrokenImage> broken_images_;
  std::vector<std::vector<IndexedStep>> steps_;  ///< by level
  std::map<std::pair<Level, std::uint32_t>, Published> published_;
  std::uint64_t unreferenced_ = 0;
  std::uint64_t found_ = 0;
  bool is_sound_ = false;
  bool is_complete_ = false;
  bool input_was_touched_ = false;
  bool has_root_ = false;
  bool is_sealed_ =
      false;  ///< others sealed the entries: what they name is checked when it is used
  std::unique_ptr<storage::EntrySink> sink_;
};

}  // namespace meshhier::pipeline
