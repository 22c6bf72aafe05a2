#include "pipeline/build_input.h"

#include <utility>

namespace meshhier::pipeline {

BuildInput::BuildInput(const Config& config, storage::FileSystem& files)
    : system_(files), weld_(config.weld), input_(files, config.input, config.weld) {
  if (needs_import())
    return;
  in_place_ = mesh_io::open_mesh(files, config.input[0]);
  description_ = in_place_->description();
}

void BuildInput::import(const Place& place) {
  storage::ScratchFile scratch(system_, place.scratch, place.pool);
  ply_.emplace(system_, place.ply, place.pool.scratch_use());
  facts_ = import_input(input_, *ply_,
                        {system_, scratch, place.sort_bytes, place.progress, place.cancel});
  description_ = mesh_io::open_mesh(system_, place.ply)->description();
}

bool BuildInput::recall(const EarlierBuild& earlier, const CancelToken& cancel) {
  const auto is = [&](const char* key, const nlohmann::json& value) {
    const auto found = earlier.decides_result.find(key);
    return found != earlier.decides_result.end() && *found == value;
  };
  const auto config = earlier.decides_result.find("config");
  if (!is("input", input_.name()) || !is("input_bytes", input_.bytes()) ||
      config == earlier.decides_result.end() || !config->contains("weld") ||
      config->at("weld") != weld_)
    return false;
  if (earlier.input_modified_ns != input_.modified_ns() &&
      checksum(cancel) != earlier.source.checksum)
    return false;
  description_.vertex_count = earlier.source.vertices;
  description_.face_count = earlier.decides_result.value("faces", std::uint64_t{0});
  description_.attributes = earlier.source.attributes;
  description_.vertices_in_place = true;
  return true;
}

std::unique_ptr<mesh_io::MeshSource> BuildInput::open() {
  return needs_import() ? mesh_io::open_mesh(system_, ply_->path()) : std::move(in_place_);
}

std::uint64_t BuildInput::checksum(const CancelToken& cancel) {
  return in_place_ ? in_place_->checksum([&] { cancel.check(); }) : input_.checksum(cancel);
}

}  // namespace meshhier::pipeline
