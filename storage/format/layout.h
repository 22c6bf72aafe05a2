// Every file name of a hierarchy, and of the work towards one, in one place. A hierarchy may also
// be one file: an archive in which files have the same names.
//
// clang-format off
//   NAME.hier/hierarchy.json
//   NAME.hier/tiles.bin
//   NAME.hier/outline.glb
//   NAME.hier/preview.webp                   unless the config says no
//   NAME.hier/objects.bin                    if the mesh has objects
//   NAME.hier/object_words.bin               if it has more than 256
//   NAME.hier/tileset.json
//   NAME.hier/tilesets/LL/NNNNNN.json        of the nodes below that one, where the tree is too large for one file
//   NAME.hier/tiles/LL/NNNNNN.glb            level (two digits or more), index in it (six or more) below 10,000
//   NAME.hier/tiles/LL/NN0000/NNNNNN.glb     any other: 10,000 in each directory
//   NAME.hier.story.json                     beside it: what people tell about it (docs/serving.md); of an archive likewise
//   NAME.prog/progressive.json
//   NAME.prog/base.bin
//   NAME.prog/detail_NN.bin                  in the order of their use, from 1 on
//   .NAME.hier.meshhier-work/                beside the output while a build runs, and after it was stopped
//   .NAME.hier.meshhier-work/lock            held by the build at work
//   .NAME.hier.meshhier-work/journal         what is done
//   .NAME.hier.meshhier-work/journal.XXXXXXXXXXXXXXXX  the same while the hierarchy gets its name
//   .NAME.hier.meshhier-work/import.ply      the input, while it is read, if it is not read in place
//   .NAME.hier.meshhier-work/*               scratch files of the stages
//   .NAME.hier.meshhier-work/hierarchy/      becomes NAME.hier
//   .NAME.3tz.meshhier-work/archive          becomes NAME.3tz, of what is in hierarchy/
//   WORK/plan.json                           of a build on many machines (pipeline/tasks)
//   WORK/segments/STAGE-NNNNN                what a task has made (segment.h)
//   WORK/attempts/*                          what tasks are making
//   WORK/hierarchy/, WORK/archive            as above
//   .NAME.hier.meshhier-old/                 a replaced hierarchy, for the moment of the rename
//   .NAME.hier.meshhier-input                by `serve --watch`: which version of which file it was made of
//   .NAME.hier.meshhier-verify-XXXXXXXX      beside a hierarchy while `verify` needs room, or one is made of a piece; a folder has a lock, too
//   .NAME.meshhier-part                      beside any other file that is written, until it is whole
//   .NAME.meshhier-scratch                   beside it, while it is made
//   .NAME.meshhier-lock                      held by who makes it
// clang-format on
#pragma once

#include "hierarchy/ids.h"
#include "storage/io/output_file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// More tiles of a level are in several directories: file servers are slow with very many names.
inline constexpr std::uint32_t kTilesADirectory = 10000;

std::filesystem::path manifest_path(const std::filesystem::path& hierarchy);
std::filesystem::path index_path(const std::filesystem::path& hierarchy);
std::filesystem::path outline_path(const std::filesystem::path& hierarchy);
std::filesystem::path preview_path(const std::filesystem::path& hierarchy);
std::filesystem::path objects_path(const std::filesystem::path& hierarchy);
std::filesystem::path object_words_path(const std::filesystem::path& hierarchy);
std::filesystem::path tileset_path(const std::filesystem::path& hierarchy);
/// Returns the file with `node` and the nodes below it. Requires node.level > 0.
std::filesystem::path tileset_path(const std::filesystem::path& hierarchy, NodeId node);
std::filesystem::path level_directory(const std::filesystem::path& hierarchy, Level level);
/// Returns all directories of the paths that tile_path() names on a level of `nodes` nodes,
/// level_directory() first.
std::vector<std::filesystem::path> tile_directories(const std::filesystem::path& hierarchy,
                                                    Level level, std::uint32_t nodes);
std::filesystem::path tile_path(const std::filesystem::path& hierarchy, NodeId node);

/// Returns the path beside a hierarchy where its story is, if somebody has written one.
std::filesystem::path story_path(const std::filesystem::path& hierarchy);
/// Returns the hierarchy whose story_path() a path is; nothing if it is none.
std::optional<std::string_view> told_of(std::string_view story);
/// A story has at most so many bytes.
inline constexpr std::uint64_t kMostStoryBytes = std::uint64_t{16} << 20;

std::filesystem::path progressive_index_path(const std::filesystem::path& stream);
/// Step 0 is the base.
std::filesystem::path detail_path(const std::filesystem::path& stream, std::uint32_t step);

/// Whether a published hierarchy may have a file of that relative name ("tiles.bin",
/// "tiles/00/000000.glb"), and whether a stream may.
bool is_hierarchy_file(std::string_view name);
bool is_stream_file(std::string_view name);
/// Returns the node whose tile_path({}, node) it is; nothing if it is none.
std::optional<NodeId> tile_of(std::string_view name);

std::filesystem::path work_path(const std::filesystem::path& output);
std::filesystem::path replaced_path(const std::filesystem::path& output);
std::filesystem::path input_note_path(const std::filesystem::path& output);
/// `run` tells several runs apart.
std::filesystem::path verify_scratch_path(const std::filesystem::path& hierarchy,
                                          std::uint32_t run);
std::filesystem::path lock_path(const std::filesystem::path& work);
std::filesystem::path journal_path(const std::filesystem::path& work);
/// `checksum`: that of the manifest of the hierarchy that the journal belongs to.
std::filesystem::path set_aside_path(const std::filesystem::path& work, std::uint64_t checksum);
std::filesystem::path built_path(const std::filesystem::path& work);
std::filesystem::path packed_path(const std::filesystem::path& work);
std::filesystem::path imported_path(const std::filesystem::path& work);
/// The table of objects that the import leaves.
std::filesystem::path imported_objects_path(const std::filesystem::path& work);
std::filesystem::path task_plan_path(const std::filesystem::path& work);
std::filesystem::path segments_path(const std::filesystem::path& work);
std::filesystem::path attempts_path(const std::filesystem::path& work);

/// The meaning of the names above that begin with a dot.
enum class Leftover {
  build,       ///< work_path: a build that was stopped
  replaced,    ///< replaced_path
  verify,      ///< verify_scratch_path
  input_note,  ///< input_note_path: left only if the hierarchy is gone
  unfinished,  ///< unfinished_path, scratch_path, output_lock_path
};
struct LeftoverName {
  Leftover kind;
  std::string output;  ///< the name of the file or hierarchy it belongs to
};
/// Returns the meaning of the name of a file or directory; nothing if it is none of them.
std::optional<LeftoverName> leftover_name(std::string_view name);

/// Whether it is the name of a file of `meshhier view` at work in a hierarchy, or of one that was
/// killed there.
bool is_manifest_at_work(std::string_view name);

}  // namespace meshhier::storage
