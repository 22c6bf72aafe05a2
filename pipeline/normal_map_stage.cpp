#include "pipeline/normal_map_stage.h"

#include "execution/memory_gate.h"
#include "hierarchy/vertex_numbers.h"
#include "images/formats.h"
#include "images/image_codec.h"
#include "pipeline/picture_levels.h"
#include "pipeline/plan/share.h"
#include "pipeline/tiles/finer_surfaces.h"
#include "shading/tile_shading.h"
#include "storage/format/tile_plan.h"
#include "texture/normal_bake.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::pipeline {
namespace {

/// An original vertex gets so many texels of a map, unless that is more than a map may have. The
/// most are for originals of few triangles and sharp edges, whose maps are off by more than
/// kGoodDegrees with fewer.
constexpr double kFewTexelsAVertex = 3;
constexpr double kMostTexelsAVertex = 12;
constexpr double kGoodDegrees = 0.5;
/// With `auto` a map is made where the tile's own shading is off by at least so many degrees, and
/// the map by no more than this part of what as many bytes of triangles would leave: with n times
/// its triangles a tile is off by 1 / sqrt(n) as much, about.
constexpr double kLeastDegrees = 1;
constexpr double kMostOfTriangles = 0.75;

/// Holds the normals of all corners, interior triangles first, as the file has them.
class CornerShading {
 public:
  CornerShading(const Forest& forest, NodeId node, const TileMesh& mesh) {
    Shading shading;
    if (forest.computes_normals()) {
      shading = shading::shade_tile(mesh, forest.normals(node), [&](std::uint32_t tile) {
        return forest.boundary_normals({node.level, tile});
      });
    }
    find_normals(mesh, shading, forest.layout(node.level));
    const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()),
                                mesh.copies.places);
    const bool split = !shading.split_of.empty();
    corners_.reserve(mesh.interior.size() + mesh.border.size());
    add(split ? shading.interior : numbers.numbered(mesh.interior, mesh.interior_wedges));
    add(split ? shading.border : numbers.numbered(mesh.border, mesh.border_wedges));
  }

  std::vector<texture::CornerNormals> take() && { return std::move(corners_); }

 private:
  /// Of all vertices and splits: those that were computed, or else those of the input.
  void find_normals(const TileMesh& mesh, const Shading& shading, const AttributeLayout& layout) {
    normals_.reserve(std::max(shading.normals.size(), mesh.vertices.size() + mesh.copies.size()));
    for (const NormalCode& code : shading.normals)
      normals_.push_back(normal_of(code));
    if (!normals_.empty())
      return;
    const AttributePart& part = layout.part(AttributeKind::normals);
    for (const VertexArray* vertices : {&mesh.vertices, &mesh.copies.vertices}) {
      for (std::size_t i = 0; i < vertices->size(); ++i) {
        const auto given = part.of(vertices->attributes_of(i));
        const Vec3f normal{given[0], given[1], given[2]};
        normals_.push_back(is_finite(normal) ? normal : Vec3f{});
      }
    }
  }

  void add(std::span<const TileTriangle> triangles) {
    for (const auto& [a, b, c] : triangles)
      corners_.push_back({normals_[raw(a)], normals_[raw(b)], normals_[raw(c)]});
  }

  std::vector<Vec3f> normals_;
  std::vector<texture::CornerNormals> corners_;
};

double area_of(const BakeSource& source) {
  double area = 0;
  for (const TileTriangle& t : source.triangles) {
    const auto corner = [&](std::size_t k) { return to_double(source.positions[raw(t[k])]); };
    area += length(cross(corner(1) - corner(0), corner(2) - corner(0))) / 2;
  }
  return area;
}

/// Memory of a triangle at work: as in the stage `texture`, and its frames.
constexpr std::uint64_t kFramedTriangleBytes = 600;

/// Returns the memory of a map at work, and of the directions that it is made of.
std::uint64_t map_bytes(std::uint32_t side) {
  constexpr double kTexelBytes = 70;
  constexpr double kSources = 16;
  constexpr double kShown = 0.45;  // so much of a picture's texels is covered
  const std::uint64_t texels = std::uint64_t{side} * side;
  constexpr double kBytes = kTexelBytes + kSources * kShown * sizeof(texture::NormalTexel);
  return static_cast<std::uint64_t>(static_cast<double>(texels) * kBytes);
}

class MapStage {
 public:
  MapStage(const Forest& forest, TextureStore& textures, const StageContext& context)
      : forest_(forest),
        textures_(textures),
        config_(context.config),
        job_(context.plan.job),
        side_(config_.normal_map.texels / texture::kBakeAlignment * texture::kBakeAlignment),
        gate_(picture_room_bytes(context.memory().work_bytes)) {}

  void make(NodeId node) {
    const TileMesh mesh = forest_.load(node).mesh;
    BakeSource source = bare_source(mesh, forest_.published_parent_map(node));
    if (source.triangles.empty()) {
      textures_.put(node, {}, source, {});
      return;
    }
    const execution::MemoryGate::Hold held = gate_.enter(map_bytes(side_));
    const std::vector<FinerSurface> finer =
        finer_surfaces(forest_, node, mesh, [&](NodeId child) { return finer_source(child); });
    std::vector<texture::NormalSurface> surfaces;
    for (const FinerSurface& one : finer)
      surfaces.push_back(one.normal_surface());
    const auto normals = CornerShading(forest_, node, mesh).take();
    const texture::NormalSurface tile{source.positions, source.triangles, normals, {}, nullptr};
    texture::NormalBaker baker(tile, surfaces, side_);
    texture::BakedNormalMap baked = bake(baker, least_texels(node, source));
    source.corners = baked.corners;
    source.directions = std::move(baked.texels);
    const TexelSizes texels{baked.texel, 0, 0};
    const Gain gain{baked.own_degrees, baked.map_degrees,
                    baked.vertices - std::min<std::size_t>(baked.vertices, mesh.vertices.size())};
    TileTexture texture = encoded(std::move(baked));
    textures_.put(node, pays(gain, mesh, texture) ? texture : TileTexture{}, source, texels);
  }

 private:
  std::shared_ptr<const BakeSource> finer_source(NodeId tile) const {
    if (!forest_.tree().is_partition(tile))
      return textures_.source(tile);
    return textures_.source(tile, [&] {
      const TileMesh mesh = forest_.load(tile).mesh;
      BakeSource source = bare_source(mesh, forest_.published_parent_map(tile));
      source.normals = CornerShading(forest_, tile, mesh).take();
      return source;
    });
  }

  /// The sizes of a texel if a vertex of the original gets few of them, or as many as it may.
  struct LeastTexels {
    float of_few = 0, of_most = 0;
  };

  LeastTexels least_texels(NodeId node, const BakeSource& source) const {
    const double area = area_of(source);
    const auto vertices = static_cast<double>(forest_.tree().ranks(node).size());
    const auto texel = [&](double a_vertex) {
      return static_cast<float>(std::sqrt(area / (a_vertex * vertices)));
    };
    return {texel(kFewTexelsAVertex), texel(kMostTexelsAVertex)};
  }

  /// Bakes a map of few texels, and with more if that is not good. Differences shrink about as
  /// texels do.
  static texture::BakedNormalMap bake(texture::NormalBaker& baker, const LeastTexels& least) {
    texture::BakedNormalMap baked = baker.bake(least.of_few);
    const bool is_largest = baked.texel > least.of_few;  // as many as a map may have
    if (is_largest || baked.map_degrees <= kGoodDegrees)
      return baked;
    const auto wanted = static_cast<float>(least.of_few * kGoodDegrees / baked.map_degrees);
    return baker.bake(std::max(wanted, least.of_most));
  }

  /// The effect of a map, and the splits that it takes.
  struct Gain {
    double own_degrees = 0, map_degrees = 0;
    std::size_t splits = 0;
  };

  bool pays(const Gain& gain, const TileMesh& mesh, const TileTexture& texture) const {
    if (config_.storage.normals == config::Normals::map)
      return true;
    // As many bytes of triangles as the map takes would make `growth` times the tile's, which is
    // then off by 1 / sqrt(growth) as much.
    const double without = plain_bytes(mesh);
    const double growth = 1 + map_bytes_of(gain, mesh, texture) / without;
    return gain.own_degrees >= kLeastDegrees &&
           gain.map_degrees * std::sqrt(growth) <= kMostOfTriangles * gain.own_degrees;
  }

  double vertex_bytes() const {
    return storage::expected_split_bytes(job_.published_attribute_bytes) * job_.published_ratio;
  }
  double plain_bytes(const TileMesh& mesh) const {
    constexpr double kTriangle = 3 * sizeof(std::uint16_t);
    const auto triangles = static_cast<double>(mesh.interior.size() + mesh.border.size());
    return static_cast<double>(mesh.vertices.size()) * vertex_bytes() +
           triangles * kTriangle * job_.published_ratio;
  }
  double map_bytes_of(const Gain& gain, const TileMesh& mesh, const TileTexture& texture) const {
    constexpr double kMapped = sizeof(TangentCode) + 2 * sizeof(std::uint16_t);
    const auto splits = static_cast<double>(gain.splits);
    return static_cast<double>(texture.normal_map.bytes.size()) + splits * vertex_bytes() +
           (static_cast<double>(mesh.vertices.size()) + splits) * kMapped * job_.published_ratio;
  }

  TileTexture encoded(texture::BakedNormalMap baked) const {
    const NormalMapFormat& format = config_.normal_map.format;
    TileTexture texture;
    texture.normal_map = {format.format, AlphaMode::opaque, baked.map.width, baked.map.height,
                          images::encode_normal_map(baked.map, format)};
    texture.corners = std::move(baked.corners);
    texture.tangents = std::move(baked.tangents);
    return texture;
  }

  const Forest& forest_;
  TextureStore& textures_;
  const config::Config& config_;
  const JobSize& job_;
  const std::uint32_t side_;
  execution::MemoryGate gate_;
};

/// Returns the texels of all maps: three levels above the partitions have about as many as the
/// original's vertices ask for, the others as many as a map may have.
double map_texels(const JobSize& job, const TilePopulation& tiles) {
  const double side = job.normal_map_side;
  const double vertices = tiles.partitions.vertices / std::max(1.0, tiles.partitions.count);
  constexpr double kShown = 0.4, kUsualTexelsAVertex = kMostTexelsAVertex;
  double texels = 0, left = tiles.simplified.count - tiles.early.count;
  for (double below = 2; left > 0.5; below *= 2) {
    const double on_level = std::min(left, std::ceil(left / 2));
    texels += on_level * std::min(side * side, below * vertices * kUsualTexelsAVertex / kShown);
    left -= on_level;
  }
  return texels;
}

}  // namespace

void make_normal_maps(const Forest& forest, TextureStore& textures, BuildJournal& journal,
                      const LevelRange& levels, const StageContext& context) {
  const int end = std::min(levels.end, int{raw(context.tree().depth())});  // above the partitions
  MapStage stage(forest, textures, context);
  make_level_by_level("normal maps", {levels.top, end, levels.share}, textures, journal, context,
                      [&](NodeId node) { stage.make(node); });
}

StageMemory normal_map_memory(const JobSize& job) {
  const std::uint64_t largest = map_bytes(job.normal_map_side);
  const std::uint64_t waiting =
      (job.threads + 1) * job.part_triangles(job.largest_tile) * kFramedTriangleBytes;
  return {largest, job.threads + 1, 2 * kLeastPictureCache + waiting + largest,
          2 * kMostPictureCache + waiting + (job.threads + 1) * largest};
}

double published_map_bytes(const JobSize& job, const TilePopulation& tiles) {
  if (job.normal_map_side == 0)
    return 0;
  const double texel = images::coders_of(job.normal_map_format).directions.file_bytes;
  constexpr double kVertex = sizeof(TangentCode) + 2 * sizeof(std::uint16_t);
  return map_texels(job, tiles) * texel + tiles.simplified.vertices * kVertex;
}

StageTimes normal_map_time(const JobSize& job, const TilePopulation& tiles) {
  constexpr double kTileSeconds = 40e-3;
  constexpr double kBakedSeconds = 220e-9;
  const double texel = kBakedSeconds + images::coders_of(job.normal_map_format).directions.seconds;
  return {{"normal maps", "tiles",
           static_cast<std::uint64_t>(tiles.simplified.count - tiles.early.count),
           tiles.simplified.count * kTileSeconds + map_texels(job, tiles) * texel}};
}

DiskVolumes normal_map_disk(const JobSize& job, const TilePopulation& tiles,
                            const MemoryPlan& /*memory*/) {
  constexpr double kShown = 0.45;
  const double directions = map_texels(job, tiles) * (kShown * sizeof(texture::NormalTexel) + 0.2);
  constexpr double kTriangle =
      sizeof(TileTriangle) + 2 * sizeof(texture::CornerTexcoords) + sizeof(texture::CornerTangents);
  return {{directions + published_map_bytes(job, tiles) + tiles.simplified.triangles * kTriangle +
               tiles.simplified.vertices * sizeof(Vec3f),
           DiskMoment::simplify, DiskMoment::simplify}};
}

}  // namespace meshhier::pipeline
