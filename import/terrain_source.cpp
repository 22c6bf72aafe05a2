#include "import/terrain_source.h"

#include "import/terrain_squares.h"
#include "mesh_io/terrain_frame.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::importing {
namespace {

/// Numbers of a vertex that shows a picture: its place there, and the material, the only one.
constexpr std::size_t kDrapeChannels = 3;

/// The memory that stays with PROJ's libraries.
constexpr std::uint64_t kProjBytes = std::uint64_t{8} << 20;

/// What has no place in the picture shows its frame.
float texcoord(double value) {
  return std::isnan(value) ? 0 : static_cast<float>(value);
}

void add_texcoords(const mesh_io::CellPlaces& drape, const TerrainCells::Run& run,
                   std::span<const double> heights, std::vector<float>& to) {
  std::vector<mesh_io::MapPoint> places(heights.size());
  drape.read(run.row, run.first, places);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (!std::isnan(heights[i]))
      to.insert(to.end(), {texcoord(places[i].x), texcoord(places[i].y), 0});
  }
}

class TerrainSource final : public mesh_io::MeshSource {
 public:
  explicit TerrainSource(Terrain terrain)
      : terrain_(std::move(terrain)),
        frame_(*terrain_.mosaic, terrain_.map),
        squares_(*terrain_.mosaic, *terrain_.cells, frame_.is_mirrored()) {
    describe();
    plan_blocks();
  }

  const mesh_io::MeshDescription& description() const override { return description_; }

  void read_vertices(const mesh_io::VertexVisitor& visit,
                     const mesh_io::BlockRunner& /*runner*/) override {
    mesh_io::BlockMemory memory;
    for (std::uint64_t i = 0; i < vertex_blocks(); ++i)
      visit(read_vertex_block(i, memory));
  }
  std::uint64_t vertex_blocks() const override {
    return (description_.vertex_count + kBlockSize - 1) / kBlockSize;
  }
  mesh_io::VertexBlock read_vertex_block(std::uint64_t index,
                                         mesh_io::BlockMemory& memory) const override;

  std::uint64_t triangle_blocks() const override { return block_ends_.size(); }
  mesh_io::TriangleBlock read_triangle_block(std::uint64_t index,
                                             mesh_io::BlockMemory& memory) const override;
  mesh_io::FaceCounts read_triangles_from(std::uint64_t face, const mesh_io::TriangleVisitor& visit,
                                          const mesh_io::BlockRunner& runner) override;

  mesh_io::OddSyntax odd_syntax() const override { return {}; }
  std::uint64_t checksum(const std::function<void()>& /*check*/) override { return 0; }
  std::vector<storage::BlockSums> known_sums() const override { return {}; }
  bool add_sums(const storage::BlockSums& /*sums*/) override { return true; }

 private:
  const TerrainCells& cells() const { return *terrain_.cells; }

  void describe() {
    description_.format = "heights";
    description_.vertex_count = cells().vertices();
    description_.place_count = frame_.keeps_apart() ? cells().vertices() : 0;
    description_.face_count = cells().triangles();
    description_.attributes.texcoords = description_.attributes.material =
        terrain_.drape != nullptr;
    description_.wide_coordinates = true;
    description_.vertices_in_place = true;
    description_.held_bytes =
        terrain_.mosaic->held_bytes() + cells().held_bytes() + frame_.held_bytes();
    if (terrain_.drape && terrain_.drape->is_changed())
      description_.held_bytes += terrain_.drape->held_bytes() + kProjBytes;
  }

  /// Runs of a block have at most kBlockSize triangles together; a run has far fewer.
  void plan_blocks() {
    static_assert(2 * TerrainCells::kRunCells <= kBlockSize);
    std::uint64_t begin = 0;
    for (std::uint64_t run = 0; run < cells().runs(); ++run) {
      if (cells().triangles_before(run + 1) - cells().triangles_before(begin) > kBlockSize) {
        block_ends_.push_back(run);
        begin = run;
      }
    }
    if (cells().triangles() > 0)
      block_ends_.push_back(cells().runs());
  }

  Terrain terrain_;
  mesh_io::TerrainFrame frame_;
  TerrainSquares squares_;
  mesh_io::MeshDescription description_;
  std::vector<std::uint64_t> block_ends_;  ///< runs behind each block of triangles
};

mesh_io::VertexBlock TerrainSource::read_vertex_block(std::uint64_t index,
                                                      mesh_io::BlockMemory& memory) const {
  const std::uint64_t first = index * kBlockSize;
  const std::uint64_t end = std::min<std::uint64_t>(first + kBlockSize, description_.vertex_count);
  const std::uint64_t first_run = cells().run_with(first);
  std::vector<double> heights;
  memory.exact.clear();
  memory.attributes.clear();
  for (std::uint64_t i = first_run; cells().vertices_before(i) < end; ++i) {
    const TerrainCells::Run run = cells().run(i);
    if (cells().vertices_before(i + 1) == cells().vertices_before(i))
      continue;
    heights.resize(run.count);
    terrain_.mosaic->read(run.row, run.first, heights);
    frame_.place(run.row, run.first, heights, memory.exact);
    if (terrain_.drape)
      add_texcoords(*terrain_.drape, run, heights, memory.attributes);
  }
  const std::span<const Vec3d> points = memory.exact;
  mesh_io::VertexBlock block;
  block.first = first;
  const std::uint64_t skipped = first - cells().vertices_before(first_run);
  block.exact = points.subspan(skipped, end - first);
  if (terrain_.drape) {
    block.attributes = std::span<const float>(memory.attributes)
                           .subspan(kDrapeChannels * skipped, kDrapeChannels * (end - first));
  }
  return block;
}

mesh_io::TriangleBlock TerrainSource::read_triangle_block(std::uint64_t index,
                                                          mesh_io::BlockMemory& memory) const {
  const std::uint64_t begin = index == 0 ? 0 : block_ends_[index - 1];
  memory.triangles.clear();
  TerrainSquares::Rows rows;
  for (std::uint64_t run = begin; run < block_ends_[index]; ++run)
    squares_.triangulate(run, rows, memory.triangles);
  return {memory.triangles, memory.triangles.size(), true};
}

mesh_io::FaceCounts TerrainSource::read_triangles_from(std::uint64_t face,
                                                       const mesh_io::TriangleVisitor& visit,
                                                       const mesh_io::BlockRunner& /*runner*/) {
  mesh_io::FaceCounts counts;
  mesh_io::BlockMemory memory;
  std::uint64_t begin = 0;  // the block's first run
  for (std::uint64_t i = 0; i < block_ends_.size(); begin = block_ends_[i++]) {
    if (cells().triangles_before(block_ends_[i]) <= face)
      continue;
    const std::uint64_t before = cells().triangles_before(begin);
    const auto all = read_triangle_block(i, memory).triangles;
    const auto wanted = all.subspan(face > before ? face - before : 0);
    counts.faces += wanted.size();
    counts.triangles += wanted.size();
    visit(wanted);
  }
  return counts;
}

}  // namespace

std::unique_ptr<mesh_io::MeshSource> open_terrain(const Terrain& terrain) {
  return std::make_unique<TerrainSource>(terrain);
}

}  // namespace meshhier::importing
