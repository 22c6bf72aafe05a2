#include "pipeline/journal/workshop.h"

#include "base/error.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/format/manifest.h"

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

/// Whether all files of a hierarchy but its tiles are there and sound.
bool is_whole(storage::FileSystem& files, const std::filesystem::path& hierarchy) {
  try {
    const storage::HierarchyReader made(files, hierarchy);
    made.read_outline();
    if (made.manifest().preview)
      made.read_preview();
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

BuildIdentity identity_of(const config::Config& config, const importing::MeshInput& input,
                          const BuildPlan& plan) {
  const Tree& tree = plan.tree;
  const mesh_io::MeshDescription& mesh = input.description();
  return {{{"program", "meshhier " MESHHIER_VERSION},
           {"format_version", storage::kFormatVersion},
           {"input", input.files().name()},
           {"input_bytes", input.files().bytes()},
           {"vertices", mesh.vertex_count},
           {"places", tree.vertex_count()},
           {"faces", mesh.face_count},
           {"partitions", tree.partition_count()},
           {"config", config::resolved_json(config)}},
          input.files().times()};
}

Workshop::Workshop(const std::filesystem::path& directory, const AttributeLayout& layout,
                   storage::MemoryPool& pool, storage::ScratchFile::Files files,
                   const StageContext& context,
                   const std::function<BuildJournal(const Workpieces&)>& open_journal)
    : mesh_scratch(context.files, directory / "mesh", pool, storage::ScratchFile::Stays::yes,
                   files),
      tile_scratch(context.files, directory / "tiles", pool, storage::ScratchFile::Stays::yes,
                   files),
      picture_scratch(context.files, directory / "pictures", pool, storage::ScratchFile::Stays::yes,
                      files),
      chunks(context.tree(), layout.channels(), context.plan.job.has_copies(), mesh_scratch,
             context.memory().spool_block_bytes),
      forest(context.tree(), chunks.level(), layout, tile_scratch,
             context.plan.job.computes_normals),
      textures(context.tree(), tile_scratch),
      pictures(picture_scratch, picture_cache_bytes(context.memory().work_bytes)),
      journal(open_journal(pieces(context))) {}

Workpieces Workshop::pieces(const StageContext& context) {
  if (context.plan.textures.is_textured())
    return {forest, chunks, &textures, &pictures};
  return {forest, chunks, context.plan.job.normal_map_side > 0 ? &textures : nullptr};
}

Workshop::Workshop(const std::filesystem::path& work, const BuildIdentity& identity,
                   const AttributeLayout& layout, storage::MemoryPool& pool,
                   const StageContext& context)
    : Workshop(work, layout, pool, storage::ScratchFile::Files::one_a_thread, context,
               [&](const Workpieces& pieces) {
                 return BuildJournal(context.files, work, identity, pool.scratch_use(), pieces,
                                     context.cancel);
               }) {}

Workshop::Workshop(const std::filesystem::path& directory, const std::filesystem::path& built,
                   const BuildIdentity& identity, const AttributeLayout& layout,
                   storage::MemoryPool& pool, std::unique_ptr<storage::EntrySink> sink,
                   const StageContext& context)
    : Workshop(directory, layout, pool, storage::ScratchFile::Files::one, context,
               [&](const Workpieces& pieces) {
                 return BuildJournal(context.files, built, identity, pieces, std::move(sink),
                                     context.cancel);
               }) {}

OpenWorkshop open_workshop(storage::WorkDirectory& work, importing::MeshInput& input,
                           storage::MemoryPool& pool, Restart restart,
                           const StageContext& context) {
  storage::FileSystem& files = context.files;
  const BuildIdentity identity = identity_of(context.config, input, context.plan);
  OpenWorkshop open;
  const auto make = [&] {
    open.workshop = std::make_unique<Workshop>(work.path(), identity,
                                               input.description().attributes, pool, context);
  };
  const auto begin_anew = [&](std::string why) {
    open.workshop.reset();
    work.clear();
    make();
    open.found = std::move(why);
  };
  const bool is_new = !files.exists(storage::journal_path(work.path()));
  if (is_new)
    work.clear();  // work that was not noted is of no use
  try {
    make();
  } catch (const Error& error) {
    if (restart == Restart::never || error.code() != ErrorCode::other_work)
      throw;
    begin_anew("a stopped build of another config or input left its work: this one began anew");
  }
  const BuildJournal& journal = open.workshop->journal;
  if (!journal.source()) {
    if (!is_new && open.found.empty())
      begin_anew("");
  } else if (!journal.is_sound() || (journal.is_complete() && !is_whole(files, work.built()))) {
    begin_anew("what an earlier build left has been damaged: this one began anew");
  } else if (journal.input_was_touched() &&
             input.checksum(context.cancel) != journal.source()->summary.checksum) {
    begin_anew("the input was changed since an earlier build was stopped: this one began anew");
  } else {
    open.found =
        fmt::format("went on where an earlier build was stopped, {} of {} steps being done",
                    journal.found(), journal.steps());
  }
  return open;
}

mesh_io::MeshDescription description_of(const EarlierBuild& build) {
  mesh_io::MeshDescription mesh;
  mesh.vertex_count = build.source.vertices;
  mesh.place_count = build.source.places;
  mesh.face_count = build.decides_result.value("faces", std::uint64_t{0});
  mesh.attributes = build.source.attributes;
  if (!build.materials.empty())
    mesh.attributes.texcoords = mesh.attributes.material = true;
  mesh.vertices_in_place = true;
  return mesh;
}

std::optional<mesh_io::MeshDescription> recall_import(const EarlierBuild& earlier,
                                                      importing::MeshInput& input,
                                                      const config::Config& asked,
                                                      const execution::CancelToken& cancel) {
  const auto is = [](const nlohmann::json& object, const char* key, const nlohmann::json& value) {
    const auto found = object.find(key);
    return found != object.end() && *found == value;
  };
  const nlohmann::json& made_of = earlier.decides_result;
  const importing::InputFiles& files = input.files();
  const auto config = made_of.find("config");
  if (!input.recall_files(earlier.input) || !is(made_of, "input", files.name()) ||
      !is(made_of, "input_bytes", files.bytes()) || config == made_of.end() ||
      !is(*config, "weld", files.weld()) ||
      !is(*config, "topology", config::resolved_json(asked).at("topology")) ||
      !is(config->value("texture", nlohmann::json::object()), "use", asked.texture.use) ||
      config->value("objects", nlohmann::json()) !=
          nlohmann::json(config::resolved_json(asked)).value("objects", nlohmann::json()))
    return std::nullopt;
  if (earlier.input_times != files.times() && input.checksum(cancel) != earlier.source.checksum)
    return std::nullopt;
  return description_of(earlier);
}

}  // namespace meshhier::pipeline
