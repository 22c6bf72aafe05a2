#include "import/place_vertices.h"

#include "execution/spool_cursor.h"
#include "hierarchy/error.h"
#include "import/renumber_triangles.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

constexpr std::uint32_t kDropped = UINT32_MAX;

/// Returns the number of each vertex in `placed`, or kDropped.
void move_vertices(const RawMesh& mesh, RawMesh& placed,
                   storage::RecordSpool<std::uint32_t>& numbers, const ImportRoom& room) {
  execution::SpoolCursor positions(mesh.positions, room.cancel);
  execution::SpoolCursor attributes(mesh.attributes, room.cancel);
  const std::size_t channels = mesh.channels();
  for (std::uint64_t i = 0; i < mesh.vertex_count(); ++i) {
    const Vec3d position = positions.at(i);
    if (!is_finite(position)) {
      numbers.append(kDropped);
      continue;
    }
    numbers.append(static_cast<std::uint32_t>(placed.vertex_count()));
    placed.positions.append(position);
    for (std::size_t c = 0; c < channels; ++c)
      placed.attributes.append(attributes.at(i * channels + c));
  }
}

}  // namespace

void count_unplaced(const mesh_io::VertexBlock& block, const std::filesystem::path& path,
                    mesh_io::UnplacedVertices& unplaced) {
  std::uint64_t vertex = block.first;
  const auto count = [&](const auto& position) {
    if (!is_finite(position) && unplaced.count++ == 0) {
      unplaced.first = mesh_io::file_message(
          path, fmt::format("vertex {} has the coordinates {} {} {}, which are not finite", vertex,
                            position.x, position.y, position.z));
    }
    ++vertex;
  };
  std::ranges::for_each(block.positions, count);
  std::ranges::for_each(block.exact, count);
}

std::uint64_t drop_unplaced(RawMesh& mesh, RawMesh& placed, const std::string& first,
                            const ImportRoom& room) {
  placed.layout = mesh.layout;
  placed.fits_float = mesh.fits_float;
  storage::RecordSpool<std::uint32_t> numbers(room.scratch, kImportSpoolBytes);
  move_vertices(mesh, placed, numbers, room);
  mesh.positions.clear();
  mesh.attributes.clear();
  renumber_triangles(mesh.triangles, numbers, room, [&](const Triangle<std::uint32_t>& t) {
    if (std::ranges::find(t, kDropped) != t.end()) {
      throw Error(ErrorCode::input,
                  first + "; that is so of vertices that faces use, so the mesh cannot be built");
    }
    placed.triangles.append(t);
  });
  mesh.triangles.clear();
  return numbers.size() - placed.vertex_count();
}

}  // namespace meshhier::importing
