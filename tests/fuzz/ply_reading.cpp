#include "fuzz/ply_reading.h"

#include "fuzz/target.h"

#include <cmath>
#include <cstring>

namespace meshhier::tests::fuzz {
namespace {

using mesh_io::BlockMemory;
using mesh_io::MeshDescription;
using mesh_io::MeshSource;
using mesh_io::TriangleBlock;
using mesh_io::VertexBlock;

template <class Read>
std::string refused(const Read& read) {
  return refusal({ErrorCode::input}, "mesh.ply: ", read);
}

void append(const MeshDescription& mesh, const VertexBlock& block, PlyReading& reading) {
  const std::size_t count = block.positions.size() + block.exact.size();
  require(count > 0 && count <= MeshSource::kBlockSize, "blocks have their size");
  require((mesh.wide_coordinates ? block.positions.size() : block.exact.size()) == 0,
          "coordinates are of one kind");
  require(block.first == reading.positions.size() + reading.exact.size(), "vertices in order");
  require(block.attributes.size() == count * static_cast<std::size_t>(mesh.attributes.channels()),
          "each vertex has its attributes");
  for (const Vec3f& p : block.positions)
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "finite floats");
  for (const Vec3d& p : block.exact)
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "finite doubles");
  const auto channels = static_cast<std::size_t>(mesh.attributes.channels());
  const auto first_value = mesh.attributes.part(AttributeKind::values).first;
  const auto behind_values = mesh.attributes.part(AttributeKind::texcoords).first;
  for (std::size_t i = 0; i < block.attributes.size(); ++i) {
    const std::size_t channel = i % channels;
    const bool is_value = channel >= first_value && channel < behind_values;
    require(is_value || std::isfinite(block.attributes[i]), "finite attributes");
  }
  reading.positions.insert(reading.positions.end(), block.positions.begin(), block.positions.end());
  reading.exact.insert(reading.exact.end(), block.exact.begin(), block.exact.end());
  reading.attributes.insert(reading.attributes.end(), block.attributes.begin(),
                            block.attributes.end());
}

void append(const MeshDescription& mesh, std::span<const Triangle<VertexId>> triangles,
            PlyReading& reading) {
  require(triangles.size() <= MeshSource::kBlockSize, "blocks have their size");
  for (const Triangle<VertexId>& t : triangles) {
    for (const VertexId corner : t)
      require(raw(corner) < mesh.vertex_count, "corners are vertices");
    require(t[0] != t[1] && t[1] != t[2] && t[2] != t[0], "no triangle is degenerate");
    reading.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
  }
}

void check_vertices(const MeshDescription& mesh, const PlyReading& reading) {
  require(reading.positions.size() + reading.exact.size() == mesh.vertex_count, "all vertices");
  require(mesh.vertex_count <= mesh.file_bytes, "no vertex without a byte");
}

void check_triangles(const MeshDescription& mesh, const PlyReading& reading) {
  require(reading.counts.faces == mesh.face_count, "all faces");
  require(reading.counts.triangles == reading.triangles.size(), "triangles are counted");
  require(reading.triangles.size() <= mesh.file_bytes, "no triangle without a byte");
}

/// Blocks that were handed out before a refusal mean nothing.
template <class Read>
void read_vertices(MeshSource& source, PlyReading& reading, const Read& read) {
  const MeshDescription& mesh = source.description();
  reading.vertex_refusal = refused([&] {
    read([&](const VertexBlock& block) { append(mesh, block, reading); });
    check_vertices(mesh, reading);
  });
  if (!reading.vertex_refusal.empty()) {
    reading.positions.clear();
    reading.exact.clear();
    reading.attributes.clear();
  }
}

template <class Read>
void read_triangles(MeshSource& source, PlyReading& reading, const Read& read) {
  const MeshDescription& mesh = source.description();
  reading.triangle_refusal = refused([&] {
    read([&](std::span<const Triangle<VertexId>> block) { append(mesh, block, reading); });
    check_triangles(mesh, reading);
  });
  if (!reading.triangle_refusal.empty())
    reading.triangles.clear();
}

void stream_vertices(MeshSource& source, PlyReading& reading) {
  read_vertices(source, reading, [&](const auto& visit) { source.read_vertices(visit); });
}

void stream_triangles(MeshSource& source, PlyReading& reading) {
  read_triangles(source, reading,
                 [&](const auto& visit) { reading.counts = source.read_triangles(visit); });
}

/// Tells of the first one of several blocks that are refused, as the stages do.
template <class Visit>
void block_vertices(const MeshSource& source, const Visit& visit) {
  const std::uint64_t count = source.vertex_blocks();
  std::vector<BlockMemory> memories(count);
  std::vector<VertexBlock> blocks(count);
  std::string first_refusal;
  for (std::uint64_t i = count; i-- > 0;) {
    const std::string refusal =
        refused([&] { blocks[i] = source.read_vertex_block(i, memories[i]); });
    if (!refusal.empty())
      first_refusal = refusal;
  }
  if (!first_refusal.empty())
    throw Error(ErrorCode::input, first_refusal);
  for (const VertexBlock& block : blocks)
    visit(block);
}

template <class Visit>
mesh_io::FaceCounts block_triangles(MeshSource& source, const Visit& visit) {
  const std::uint64_t count = source.triangle_blocks();
  std::vector<BlockMemory> memories(count);
  std::vector<TriangleBlock> blocks(count);
  for (std::uint64_t i = count; i-- > 0;)
    blocks[i] = source.read_triangle_block(i, memories[i]);
  mesh_io::FaceCounts counts;
  for (const TriangleBlock& block : blocks) {
    visit(block.triangles);
    counts.faces += block.faces;
    counts.triangles += block.triangles.size();
    if (!block.whole)
      break;
  }
  counts.degenerate_triangles = counts.faces - counts.triangles;
  const mesh_io::FaceCounts rest = source.read_triangles_from(counts.faces, visit, {});
  return {counts.faces + rest.faces,
          counts.triangles + rest.triangles,
          counts.degenerate_triangles + rest.degenerate_triangles,
          {}};
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_words(const std::string& a, const std::string& b, bool words) {
  return words ? a == b : a.empty() == b.empty();
}

}  // namespace

PlyReading read_as_stream(MeshSource& source) {
  PlyReading reading;
  stream_vertices(source, reading);
  stream_triangles(source, reading);
  return reading;
}

PlyReading read_as_stream_backwards(MeshSource& source) {
  PlyReading reading;
  stream_triangles(source, reading);
  stream_vertices(source, reading);
  return reading;
}

PlyReading read_in_blocks(MeshSource& source) {
  PlyReading reading;
  if (source.vertex_blocks() > 0) {
    read_vertices(source, reading, [&](const auto& visit) { block_vertices(source, visit); });
  } else {
    stream_vertices(source, reading);
  }
  read_triangles(source, reading,
                 [&](const auto& visit) { reading.counts = block_triangles(source, visit); });
  return reading;
}

bool is_same(const PlyReading& a, const PlyReading& b, bool words) {
  const bool counts = a.counts.faces == b.counts.faces &&
                      a.counts.triangles == b.counts.triangles &&
                      a.counts.degenerate_triangles == b.counts.degenerate_triangles;
  return same_bits(a.positions, b.positions) && same_bits(a.exact, b.exact) &&
         same_bits(a.attributes, b.attributes) && same_bits(a.triangles, b.triangles) &&
         (counts || !a.triangle_refusal.empty()) &&
         same_words(a.vertex_refusal, b.vertex_refusal, words) &&
         same_words(a.triangle_refusal, b.triangle_refusal, words);
}

}  // namespace meshhier::tests::fuzz
