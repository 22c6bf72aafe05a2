#include "pipeline/pack_stage.h"

#include "pipeline/publish_stage.h"
#include "storage/format/archive_writer.h"
#include "storage/format/layout.h"
#include "storage/format/object_facts.h"
#include "storage/format/tileset.h"

#include <functional>
#include <span>
#include <vector>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;

/// Visits the names of all files, relative to the hierarchy, in the archive's order: those that a
/// reader opens first come first, and their places follow from sizes that the manifest and the
/// index tell.
void for_each_name(const storage::HierarchyReader& made,
                   const std::function<void(const fs::path&)>& visit) {
  const std::vector<TileRecord>& tiles = made.records();
  visit(storage::manifest_path({}));
  visit(storage::tile_path({}, tiles.front().node));
  visit(storage::index_path({}));
  visit(storage::outline_path({}));
  if (made.manifest().preview)
    visit(storage::preview_path({}));
  const auto& objects = made.manifest().objects;
  if (objects)
    visit(storage::objects_path({}));
  for (const TileRecord& record : std::span(tiles).subspan(1))
    visit(storage::tile_path({}, record.node));
  storage::for_each_tileset(made.manifest(), made.tree(), tiles,
                            [&](const storage::TilesetFile& file) { visit(file.path); });
  if (objects && objects->words)  // behind all files whose places earlier readers work out
    visit(storage::object_words_path({}));
}

}  // namespace

std::uint64_t pack(const storage::HierarchyReader& made, const fs::path& file,
                   storage::ScratchUse& use, const StageContext& context) {
  storage::FileSystem& files = context.files;
  const storage::Manifest& manifest = made.manifest();
  // Manifest, index, outline, and what there may be besides.
  const std::uint64_t others = 3 + std::uint64_t{manifest.preview.has_value()} +
                               storage::object_files(manifest.objects).size();
  context.progress.stage("pack", others + manifest.tileset_files + made.records().size(), "files");
  const std::unique_ptr<storage::File> archive = files.create(file);
  storage::ArchiveWriter writer(*archive, [&] { context.cancel.check(); });
  for_each_name(made, [&](const fs::path& name) {
    const std::unique_ptr<storage::File> content = files.open(made.directory() / name);
    writer.add(name.generic_string(), *content);
    use.add_read(content->size());
    context.progress.advance(1);
  });
  writer.finish();
  archive->sync([&] { context.cancel.check(); });
  return writer.bytes();
}

double published_bytes(const JobSize& job, const TilePopulation& tiles) {
  return publish_output(job, tiles).bytes + (job.packed ? archive_overhead_bytes(tiles) : 0);
}

StageTimes pack_time(const JobSize& job, const TilePopulation& tiles) {
  constexpr double kMoves = 2;  // read and written
  return {{"pack", "files", static_cast<std::uint64_t>(tiles.files()),
           kMoves * published_bytes(job, tiles) / kDiskBytesPerSecond}};
}

double archive_overhead_bytes(const TilePopulation& tiles) {
  return tiles.files() * storage::kArchivedFileOverhead;
}

}  // namespace meshhier::pipeline
