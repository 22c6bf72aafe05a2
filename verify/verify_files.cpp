#include "base/error.h"
#include "base/plain_text.h"
#include "hierarchy/cut.h"
#include "storage/format/layout.h"
#include "storage/format/object_facts.h"
#include "storage/format/system_files.h"
#include "storage/format/tileset.h"
#include "storage/io/hash.h"
#include "verify/verify_parts.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

namespace fs = std::filesystem;

/// `relative` is the name that storage/format/layout.h gives to the file of one of the tree's
/// tiles.
bool is_tile_file(const Tree& tree, const fs::path& relative) {
  const auto node = storage::tile_of(relative.generic_string());
  return node && tree.contains(*node) && tree.tile_node(*node) == *node;
}

bool is_known(const VerifyJob& job, const std::set<fs::path>& tilesets, const fs::path& relative) {
  const bool has_preview = job.reader.manifest().preview.has_value();
  return relative == storage::manifest_path({}) || relative == storage::index_path({}) ||
         relative == storage::outline_path({}) ||
         (has_preview && relative == storage::preview_path({})) ||
         std::ranges::any_of(storage::object_files(job.reader.manifest().objects),
                             [&](const auto& file) { return relative == file.name; }) ||
         is_tile_file(job.tree(), relative) || tilesets.contains(relative);
}

/// The directories that hold the hierarchy's files, as names in it.
std::set<fs::path> known_directories(const Tree& tree, const std::set<fs::path>& tilesets) {
  std::set<fs::path> known;
  const auto add_above = [&](const fs::path& path) {
    for (fs::path above = path; !above.empty(); above = above.parent_path())
      known.insert(above);
  };
  for (int l = 0; l <= raw(tree.depth()); ++l) {
    const auto level = static_cast<Level>(l);
    for (const fs::path& directory : storage::tile_directories({}, level, tree.node_count(level)))
      add_above(directory);
  }
  for (const fs::path& tileset : tilesets)
    add_above(tileset.parent_path());
  return known;
}

/// Returns whether a file is neither the hierarchy's nor one that systems leave in folders, or
/// `meshhier view` while it changes the manifest.
bool is_strange(const VerifyJob& job, const fs::path& path) {
  const std::string name = path.lexically_relative(job.reader.directory()).generic_string();
  return !storage::is_system_file(name) && !storage::is_manifest_at_work(name);
}

/// Looks for directories that hold none of the hierarchy's files, and for links, at `directory`
/// and below it.
void find_strange_entries(const VerifyJob& job, const std::set<fs::path>& known,
                          const fs::path& directory) {
  for (const fs::path& path : job.files.children(directory)) {
    job.cancel.check();
    if (job.files.is_link(path)) {
      job.problems.add(fmt::format("{}: a link; put the file itself in its place", path.string()));
    } else if (job.files.is_directory(path)) {
      if (known.contains(path.lexically_relative(job.reader.directory())))
        find_strange_entries(job, known, path);
      else if (is_strange(job, path))
        job.problems.add(
            fmt::format("{}: not a directory of this hierarchy; remove it", path.string()));
    }
  }
}

struct FoundFiles {
  std::uint64_t all = 0;
  std::uint64_t of_systems = 0;  ///< those of them that systems leave in folders
};

/// A missing file is found by whoever reads it; what is looked for here is what nobody reads.
/// Nothing if nothing can be listed.
std::optional<FoundFiles> find_extra_files(const VerifyJob& job,
                                           const std::set<fs::path>& tilesets) {
  const fs::path& directory = job.reader.directory();
  if (!job.files.can_list(directory))
    return std::nullopt;
  FoundFiles found;
  for (const fs::path& path : job.files.list(directory)) {
    ++found.all;
    if (is_known(job, tilesets, path.lexically_relative(directory)))
      continue;
    if (is_strange(job, path))
      job.problems.add(fmt::format("{}: not a file of this hierarchy; remove it", path.string()));
    else
      ++found.of_systems;
  }
  if (job.files.is_directory(directory))  // an archive has files only
    find_strange_entries(job, known_directories(job.tree(), tilesets), directory);
  return found;
}

std::string files_text(const std::optional<FoundFiles>& found, const std::string& tiles) {
  if (!found) {
    return fmt::format(
        "files: {} in the index; on the web nothing can be listed, so others that "
        "lie beside them are not seen",
        tiles);
  }
  std::string text = fmt::format("files: {} found, {} in the index", found->all, tiles);
  if (found->of_systems > 0)
    text += fmt::format("; {} left there by a system or an unpacker",
                        counted(found->of_systems, "files"));
  return text;
}

void check_outline(const VerifyJob& job) {
  try {
    const Outline outline = job.reader.read_outline();
    verify_outline(job, outline);
    job.checks.push_back(fmt::format("outline: {}, {}",
                                     counted(job.reader.manifest().outline_bytes, "bytes"),
                                     counted(outline.polyline_count(), "lines")));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt && error.code() != ErrorCode::io)
      throw;
    job.problems.add(error.what());
  }
}

/// Compares the files of the tileset with what follows from manifest and index. Returns their
/// names.
std::set<fs::path> check_tilesets(const VerifyJob& job) {
  const storage::Manifest& manifest = job.reader.manifest();
  std::set<fs::path> names;
  std::uint64_t bytes = 0;
  storage::Checksum sum;
  const auto look_at = [&](const storage::TilesetFile& file) {
    const auto expected = std::as_bytes(std::span(file.text));
    bytes += expected.size();
    sum.add(expected);
    names.insert(file.path);
    const fs::path path = job.reader.directory() / file.path;
    if (!job.files.exists(path)) {
      job.problems.add(fmt::format("{}: this file of the tileset is missing", path.string()));
      return;
    }
    const std::unique_ptr<storage::File> found = job.files.open(path);
    std::vector<std::byte> content(std::min<std::uint64_t>(found->size(), expected.size() + 1));
    found->read_exact(0, content);
    if (!std::equal(content.begin(), content.end(), expected.begin(), expected.end()))
      job.problems.add(fmt::format("{}: not the tileset of this hierarchy", path.string()));
  };
  storage::for_each_tileset(manifest, job.tree(), job.reader.records(), [&](const auto& file) {
    try {
      look_at(file);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::io)
        throw;
      job.problems.add(error.what());
    }
  });
  if (names.size() != manifest.tileset_files || bytes != manifest.tileset_bytes ||
      sum.value() != manifest.tileset_checksum) {
    job.problems.add(
        fmt::format("{}: the tileset is said to have {} files and {} bytes; it should "
                    "have {} and {}, and their checksum",
                    storage::manifest_path(job.reader.directory()).string(), manifest.tileset_files,
                    manifest.tileset_bytes, names.size(), bytes));
  }
  job.checks.push_back(
      fmt::format("tileset: {}, {}", counted(names.size(), "files"), counted(bytes, "bytes")));
  return names;
}

}  // namespace

void verify_files(const VerifyJob& job) {
  const std::optional<FoundFiles> found = find_extra_files(job, check_tilesets(job));
  check_outline(job);
  verify_preview(job);
  const std::string tiles = counted(job.reader.records().size(), "tiles");
  job.checks.push_back(files_text(found, tiles));
}

}  // namespace meshhier::verifying
