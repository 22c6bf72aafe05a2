#include "import/mesh_input.h"

#include <utility>

namespace meshhier::importing {

MeshInput::MeshInput(const mesh_io::InputPaths& paths, bool weld, storage::FileSystem& files)
    : system_(files), input_(files, paths, weld) {
  if (needs_import())
    return;
  in_place_ = mesh_io::open_mesh(files, paths[0]);
  description_ = in_place_->description();
}

void MeshInput::import(const Place& place) {
  storage::ScratchFile scratch(system_, place.scratch, place.pool);
  ply_.emplace(system_, place.ply, place.pool.scratch_use());
  facts_ = import_input(input_, *ply_,
                        {system_, scratch, place.sort_bytes, place.progress, place.cancel});
  description_ = mesh_io::open_mesh(system_, place.ply)->description();
}

std::unique_ptr<mesh_io::MeshSource> MeshInput::open() {
  return needs_import() ? mesh_io::open_mesh(system_, ply_->path()) : std::move(in_place_);
}

std::uint64_t MeshInput::checksum(const execution::CancelToken& cancel) {
  return in_place_ ? in_place_->checksum([&] { cancel.check(); }) : input_.checksum(cancel);
}

}  // namespace meshhier::importing
