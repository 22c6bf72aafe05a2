#include "ply_samples.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

void read_vertices(MeshSource& source, ReadMesh& mesh) {
  const MeshDescription& about = source.description();
  const auto channels = static_cast<std::size_t>(about.attributes.channels());
  source.read_vertices([&](const VertexBlock& block) {
    const std::size_t count = std::max(block.positions.size(), block.exact.size());
    EXPECT_EQ(block.first, mesh.positions.size());
    EXPECT_GT(count, 0U);
    EXPECT_LE(count, MeshSource::kBlockSize);
    EXPECT_TRUE(about.wide_coordinates ? block.positions.empty() : block.exact.empty());
    EXPECT_EQ(block.attributes.size(), count * channels);
    for (const Vec3f& p : block.positions)
      mesh.positions.push_back(to_double(p));
    mesh.positions.insert(mesh.positions.end(), block.exact.begin(), block.exact.end());
    mesh.attributes.insert(mesh.attributes.end(), block.attributes.begin(), block.attributes.end());
  });
  EXPECT_EQ(mesh.positions.size(), about.vertex_count);
}

void read_triangles(MeshSource& source, ReadMesh& mesh) {
  mesh.counts = source.read_triangles([&](std::span<const Triangle<VertexId>> block) {
    EXPECT_GT(block.size(), 0U);
    EXPECT_LE(block.size(), MeshSource::kBlockSize);
    for (const Triangle<VertexId>& t : block) {
      for (const VertexId corner : t)
        EXPECT_LT(raw(corner), source.description().vertex_count);
      mesh.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
    }
  });
  EXPECT_EQ(mesh.counts.triangles, mesh.triangles.size());
  EXPECT_EQ(mesh.counts.faces, source.description().face_count);
}

void append(const VertexBlock& block, ReadMesh& mesh) {
  EXPECT_EQ(block.first, mesh.positions.size());
  EXPECT_LE(block.positions.size() + block.exact.size(), MeshSource::kBlockSize);
  for (const Vec3f& p : block.positions)
    mesh.positions.push_back(to_double(p));
  mesh.positions.insert(mesh.positions.end(), block.exact.begin(), block.exact.end());
  mesh.attributes.insert(mesh.attributes.end(), block.attributes.begin(), block.attributes.end());
}

void append(std::span<const Triangle<VertexId>> triangles, ReadMesh& mesh) {
  EXPECT_LE(triangles.size(), MeshSource::kBlockSize);
  for (const Triangle<VertexId>& t : triangles)
    mesh.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
}

/// Calls read(i) for all i < count.
template <class Read>
void for_each_block(std::uint64_t count, bool backwards, const Read& read) {
  for (std::uint64_t i = 0; i < count; ++i)
    read(backwards ? count - 1 - i : i);
}

void read_vertex_blocks(MeshSource& source, bool backwards, ReadMesh& mesh) {
  const std::uint64_t count = source.vertex_blocks();
  EXPECT_EQ(count > 0, source.description().vertices_in_place && mesh.description.vertex_count > 0);
  if (count == 0)
    source.read_vertices([&](const VertexBlock& block) { append(block, mesh); });
  std::vector<BlockMemory> memories(count);
  std::vector<VertexBlock> blocks(count);
  for_each_block(count, backwards,
                 [&](std::uint64_t i) { blocks[i] = source.read_vertex_block(i, memories[i]); });
  for (const VertexBlock& block : blocks)
    append(block, mesh);
}

void read_triangle_blocks(MeshSource& source, bool backwards, ReadMesh& mesh) {
  const std::uint64_t count = source.triangle_blocks();
  std::vector<BlockMemory> memories(count);
  std::vector<TriangleBlock> blocks(count);
  for_each_block(count, backwards,
                 [&](std::uint64_t i) { blocks[i] = source.read_triangle_block(i, memories[i]); });
  std::uint64_t faces = 0;
  for (const TriangleBlock& block : blocks) {
    append(block.triangles, mesh);
    faces += block.faces;
    if (!block.whole)
      break;
  }
  mesh.counts = {faces, mesh.triangles.size(), faces - mesh.triangles.size(), {}};
  const FaceCounts rest = source.read_triangles_from(
      faces, [&](std::span<const Triangle<VertexId>> block) { append(block, mesh); }, {});
  mesh.counts.faces += rest.faces;
  mesh.counts.triangles += rest.triangles;
  mesh.counts.degenerate_triangles += rest.degenerate_triangles;
}

}  // namespace

ReadMesh read_in_blocks(MeshSource& source, bool backwards) {
  ReadMesh mesh;
  mesh.description = source.description();
  read_vertex_blocks(source, backwards, mesh);
  read_triangle_blocks(source, backwards, mesh);
  return mesh;
}

/// Values need not be numbers.
static bool have_equal_bits(std::span<const float> a, std::span<const float> b) {
  return std::ranges::equal(std::as_bytes(a), std::as_bytes(b));
}

ReadMesh read_mesh(MeshSource& source) {
  ReadMesh mesh;
  mesh.description = source.description();
  read_vertices(source, mesh);
  read_triangles(source, mesh);
  ReadMesh again;
  read_triangles(source, again);
  read_vertices(source, again);
  for (const ReadMesh& other :
       {again, read_in_blocks(source, false), read_in_blocks(source, true)}) {
    EXPECT_EQ(other.positions, mesh.positions);
    EXPECT_TRUE(have_equal_bits(other.attributes, mesh.attributes));
    EXPECT_EQ(other.triangles, mesh.triangles);
    EXPECT_EQ(other.counts.faces, mesh.counts.faces);
    EXPECT_EQ(other.counts.triangles, mesh.counts.triangles);
    EXPECT_EQ(other.counts.degenerate_triangles, mesh.counts.degenerate_triangles);
  }
  return mesh;
}

ReadMesh read_bytes(const Bytes& bytes, const AttributeChoice& attributes) {
  MemoryFiles files;
  files.put(std::string(kFileName), bytes);
  return read_mesh(*open_mesh(files, kFileName, attributes));
}

namespace {

template <class Read>
std::string error_of_reading(const Bytes& bytes, const Read& read) {
  MemoryFiles files;
  files.put(std::string(kFileName), bytes);
  try {
    read(*open_mesh(files, kFileName));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
    EXPECT_TRUE(std::string(error.what()).starts_with(std::string(kFileName) + ": "))
        << error.what();
    return error.what();
  }
  ADD_FAILURE() << "expected an error, found none";
  return {};
}

}  // namespace

std::string error_of(const Bytes& bytes) {
  const std::string error = error_of_reading(bytes, [](MeshSource& source) { read_mesh(source); });
  EXPECT_EQ(error_of_reading(bytes, [](MeshSource& source) { read_in_blocks(source, false); }),
            error);
  return error;
}

PlyText::PlyText(PlyEncoding encoding, std::string line_end)
    : encoding_(encoding), line_end_(std::move(line_end)) {
  constexpr std::string_view kNames[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  line("ply");
  line(fmt::format("format {} 1.0", kNames[static_cast<std::size_t>(encoding)]));
}

PlyText& PlyText::line(const std::string& text) {
  bytes_ += text + line_end_;
  return *this;
}

PlyText& PlyText::end_header() {
  return line("end_header");
}

namespace {

template <class T>
void append_raw(Bytes& bytes, double number, bool big) {
  auto raw_bytes = std::bit_cast<std::array<char, sizeof(T)>>(static_cast<T>(number));
  if (big != (std::endian::native == std::endian::big)) {
    std::reverse(raw_bytes.begin(), raw_bytes.end());
  }
  bytes.append(raw_bytes.data(), raw_bytes.size());
}

}  // namespace

PlyText& PlyText::value(PlyType type, double number) {
  if (encoding_ == PlyEncoding::ascii) {
    if (row_begun_)
      bytes_ += ' ';
    row_begun_ = true;
    bytes_ += type == PlyType::f32 ? fmt::format("{}", static_cast<float>(number))
                                   : fmt::format("{}", number);
    return *this;
  }
  const bool big = encoding_ == PlyEncoding::big_endian;
  using Append = void (*)(Bytes&, double, bool);
  constexpr Append kAppend[] = {append_raw<std::int8_t>,  append_raw<std::uint8_t>,
                                append_raw<std::int16_t>, append_raw<std::uint16_t>,
                                append_raw<std::int32_t>, append_raw<std::uint32_t>,
                                append_raw<float>,        append_raw<double>,
                                append_raw<std::int64_t>, append_raw<std::uint64_t>};
  kAppend[static_cast<std::size_t>(type)](bytes_, number, big);
  return *this;
}

PlyText& PlyText::end_row() {
  if (encoding_ == PlyEncoding::ascii)
    bytes_ += line_end_;
  row_begun_ = false;
  return *this;
}

PlyText& PlyText::row(PlyType type, std::initializer_list<double> numbers) {
  for (const double number : numbers)
    value(type, number);
  return end_row();
}

PlyText& PlyText::list(PlyType count, PlyType item, std::initializer_list<double> numbers) {
  value(count, static_cast<double>(numbers.size()));
  for (const double number : numbers)
    value(item, number);
  return end_row();
}

Bytes tetrahedron(PlyEncoding encoding, PlyType coordinate, PlyType count, PlyType index) {
  PlyText ply(encoding);
  ply.line("element vertex 4");
  for (const char axis : {'x', 'y', 'z'}) {
    ply.line(fmt::format("property {} {}", name_of(coordinate), axis));
  }
  ply.line("element face 4");
  ply.line(fmt::format("property list {} {} vertex_indices", name_of(count), name_of(index)));
  ply.end_header();
  ply.row(coordinate, {1, 2, 3}).row(coordinate, {10, 2, 3});
  ply.row(coordinate, {1, 20, 3}).row(coordinate, {1, 2, 30});
  ply.list(count, index, {0, 2, 1}).list(count, index, {0, 1, 3});
  ply.list(count, index, {1, 2, 3}).list(count, index, {2, 0, 3});
  return ply.bytes();
}

}  // namespace meshhier::mesh_io::tests
