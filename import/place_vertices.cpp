#include "import/place_vertices.h"

#include "base/error.h"
#include "execution/spool_cursor.h"
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

DroppedUnplaced drop_unplaced(RawMesh& mesh, RawMesh& placed, const std::string& first,
                              const ImportRoom& room) {
  placed.layout = mesh.layout;
  placed.fits_float = mesh.fits_float;
  storage::RecordSpool<std::uint32_t> numbers(room.scratch, kImportSpoolBytes);
  move_vertices(mesh, placed, numbers, room);
  mesh.positions.clear();
  mesh.attributes.clear();
  DroppedUnplaced dropped{.vertices = numbers.size() - placed.vertex_count()};
  renumber_triangles(mesh.triangles, numbers, room, [&](const Triangle<std::uint32_t>& t) {
    const bool is_placed = std::ranges::find(t, kDropped) == t.end();
    dropped.triangles += is_placed ? 0 : 1;
    if (is_placed)
      placed.triangles.append(t);
  });
  mesh.triangles.clear();
  if (dropped.triangles > placed.triangles.size()) {
    throw Error(ErrorCode::input,
                first + "; most triangles use such vertices, so the mesh cannot be built");
  }
  return dropped;
}

}  // namespace meshhier::importing
