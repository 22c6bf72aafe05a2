#include "import/append_mesh.h"

#include "base/error.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::importing {
namespace {

constexpr std::uint64_t kAppendBlock = 8192;

/// Moves all records by blocks, each changed by `change`.
template <class Record, class Change>
void append_all(const storage::RecordSpool<Record>& from, std::uint64_t block_records,
                storage::RecordSpool<Record>& to, const execution::CancelToken& cancel,
                const Change& change) {
  std::vector<Record> block;
  for (std::uint64_t i = 0; i < from.size(); i += block.size()) {
    cancel.check();
    block.resize(std::min(block_records, from.size() - i));
    from.read(i, block);
    change(std::span(block));
    to.append(std::span<const Record>(block));
  }
}

}  // namespace

std::uint32_t next_vertex(const RawMesh& mesh, const std::filesystem::path& path,
                          std::uint64_t more) {
  const std::uint64_t base = mesh.vertex_count();
  if (more >= UINT32_MAX || base + more >= UINT32_MAX)
    mesh_io::fail_file(path, "with it the input has 2^32 vertices or more; split it");
  return static_cast<std::uint32_t>(base);
}

void append_triangles(std::span<const Triangle<VertexId>> triangles, std::uint32_t base,
                      RawMesh& mesh) {
  for (const Triangle<VertexId>& t : triangles) {
    mesh.triangles.append(
        Triangle<std::uint32_t>{base + raw(t[0]), base + raw(t[1]), base + raw(t[2])});
  }
}

void append_mesh(RawMesh&& from, RawMesh& to, const execution::CancelToken& cancel) {
  const std::uint64_t base = to.vertex_count();
  if (base + from.vertex_count() >= UINT32_MAX)
    throw Error(ErrorCode::input, "the input has 2^32 vertices or more; split it");
  const auto first_material = static_cast<float>(to.materials.append(std::move(from.materials)));
  const std::size_t channels = from.channels();
  if (from.objects && to.objects)
    to.objects->append(*from.objects);
  append_all(from.positions, kAppendBlock, to.positions, cancel, [](auto) {});
  append_all(from.attributes, kAppendBlock * std::max<std::size_t>(channels, 1), to.attributes,
             cancel, [&](std::span<float> block) {
               if (!from.layout.material || first_material == 0)
                 return;
               const std::size_t at = from.layout.part(AttributeKind::material).first;
               for (std::size_t i = at; i < block.size(); i += channels)
                 block[i] += first_material;
             });
  append_all(from.triangles, kAppendBlock, to.triangles, cancel,
             [&](std::span<Triangle<std::uint32_t>> block) {
               for (Triangle<std::uint32_t>& triangle : block) {
                 for (std::uint32_t& corner : triangle)
                   corner += static_cast<std::uint32_t>(base);
               }
             });
}

}  // namespace meshhier::importing
