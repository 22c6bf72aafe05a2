#include "pipeline/normal_map_stage.h"

#include "execution/memory_gate.h"
#include "images/formats.h"
#include "images/image_codec.h"
#include "pipeline/picture_levels.h"
#include "pipeline/plan/share.h"
#include "pipeline/tiles/finer_surfaces.h"
#include "pipeline/tiles/tile_normals.h"
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
constexpr double kGoodDegrees = 0.48;
/// With `auto` a map is made where the tile's own shading is off by at least so many degrees, and
/// the map by no more than this part of what as many bytes of triangles would leave: with n times
/// its triangles a tile is off by 1 / sqrt(n) as much, about.
constexpr double kLeastDegrees = 1;
constexpr double kMostOfTriangles = 0.75;

/// Returns the size of a texel of so many on a surface.
float texel_for(const BakeSource& source, double texels) {
  double area = 0;
  for (const TileTriangle& t : source.triangles) {
    const auto corner = [&](std::size_t k) { return to_double(source.positions[raw(t[k])]); };
    area += length(cross(corner(1) - corner(0), corner(2) - corner(0))) / 2;
  }
  return static_cast<float>(std::sqrt(area / texels));
}

/// Returns how many levels from the root on have maps. The root has one wherever there is a tile
/// above the partitions.
int mapped_levels(int depth, const JobSize& job) {
  return std::max(depth - job.unmapped_levels, std::min(depth, 1));
}

/// Returns the memory of a map at work.
std::uint64_t texel_bytes(std::uint32_t side) {
  constexpr std::uint64_t kTexelBytes = 70;
  return kTexelBytes * side * side;
}

/// Returns the memory of a map at work that is made from partitions, and of these.
std::uint64_t first_map_bytes(const JobSize& job) {
  constexpr std::uint64_t kTriangleBytes = 130;
  const std::uint64_t below = std::uint64_t{2} << job.unmapped_levels;
  return texel_bytes(job.normal_map_side) +
         kTriangleBytes *
             std::min(below * job.part_triangles(job.largest_tile), 2 * job.face_count);
}

class MapStage {
 public:
  /// `end`: levels from there on have no maps.
  MapStage(const Forest& forest, TextureStore& textures, int end, const StageContext& context)
      : forest_(forest),
        textures_(textures),
        config_(context.config),
        job_(context.plan.job),
        end_(end),
        side_(config_.normal_map.texels / texture::kBakeAlignment * texture::kBakeAlignment),
        gate_(picture_room_bytes(context.memory().work_bytes)) {}

  void make(NodeId node) {
    const TileMesh mesh = forest_.load(node).mesh;
    BakeSource source = bare_source(mesh, forest_.published_parent_map(node));
    if (source.triangles.empty()) {
      textures_.put(node, {}, source, {});
      return;
    }
    const bool is_first = finer_level(node) != finer(node.level);
    const execution::MemoryGate::Hold held =
        gate_.enter(is_first ? first_map_bytes(job_) : map_bytes(side_));
    const std::vector<FinerSurface> finer =
        finer_surfaces(forest_, node, finer_level(node), mesh,
                       [&](NodeId tile) { return finer_source(tile, node.level); });
    std::vector<texture::NormalSurface> surfaces;
    for (const FinerSurface& one : finer)
      surfaces.push_back(one.normal_surface());
    const auto normals = corner_normals(node, mesh);
    const texture::NormalSurface tile{source.positions, source.triangles, normals, {}, nullptr};
    texture::NormalBaker baker(tile, surfaces, side_);
    const LeastTexels least = least_texels(node, source);
    texture::BakedNormalMap baked = is_first ? baker.bake(least.of_most, least_degrees())
                                             : bake(baker, least, degrees_of_texel(node));
    source.corners = baked.corners;
    source.directions = std::move(baked.texels);
    const TexelSizes texels{baked.texel, 0, 0, static_cast<float>(baked.map_degrees)};
    const Gain gain{baked.own_degrees, baked.map_degrees,
                    baked.vertices - std::min<std::size_t>(baked.vertices, mesh.vertices.size())};
    TileTexture texture;
    if (!baked.map.texels.empty())
      texture = encoded(std::move(baked));
    const bool is_kept = !texture.normal_map.empty() && pays(gain, mesh, texture);
    textures_.put(node, is_kept ? texture : TileTexture{}, std::move(source), texels);
  }

 private:
  std::vector<texture::CornerNormals> corner_normals(NodeId node, const TileMesh& mesh) const {
    return pipeline::corner_normals(mesh, forest_.layout(node.level),
                                    computed_shading(forest_, node, mesh));
  }

  /// The level that a node's map is made from: the next one, or the partitions if that has no maps.
  /// So many partitions have vertices for as many texels as a map may have.
  Level finer_level(NodeId node) const {
    return raw(node.level) + 1 < end_ ? finer(node.level) : forest_.tree().depth();
  }

  std::shared_ptr<const BakeSource> finer_source(NodeId tile, Level level) const {
    if (!forest_.tree().is_partition(tile))
      return textures_.source(tile);
    return textures_.source(tile, [&] {
      const TileMesh mesh = forest_.load(tile).mesh;
      BakeSource source = bare_source(mesh, forest_.map_up(tile, level));
      source.normals = corner_normals(tile, mesh);
      return source;
    });
  }

  /// The sizes of a texel if a vertex of the original gets few of them, or as many as it may.
  struct LeastTexels {
    float of_few = 0, of_most = 0;
  };

  LeastTexels least_texels(NodeId node, const BakeSource& source) const {
    const auto vertices = static_cast<double>(forest_.tree().ranks(node).size());
    return {texel_for(source, kFewTexelsAVertex * vertices),
            texel_for(source, kMostTexelsAVertex * vertices)};
  }

  /// Returns how much the children's maps are off, for each unit of the size of their texels: about
  /// as much as the node's, since both show the same original. 0 above partitions, which have none.
  double degrees_of_texel(NodeId node) const {
    double sum = 0, count = 0;
    const Tree::Children children = forest_.tree().children(node);
    for (const NodeId child : children.span()) {
      const TexelSizes& texels = textures_.texels(forest_.tree().tile_node(child));
      if (texels.own > 0)
        sum += texels.degrees / texels.own, ++count;
    }
    return count > 0 ? sum / count : 0;
  }

  double least_degrees() const {
    return config_.storage.normals == config::Normals::map ? 0 : kLeastDegrees;
  }

  /// Bakes a map of few texels, or of more if that would not be good, as coarser tiles are made of
  /// its directions. Differences shrink about as texels do; where no child tells how large they
  /// are, a map of few texels does.
  texture::BakedNormalMap bake(texture::NormalBaker& baker, const LeastTexels& least,
                               double degrees_of_texel) const {
    const auto wanted = [&](double degrees_of_few) {
      return std::max(static_cast<float>(least.of_few * kGoodDegrees / degrees_of_few),
                      least.of_most);
    };
    const double expected = degrees_of_texel * double{least.of_few};
    if (expected > kGoodDegrees)
      return baker.bake(wanted(expected), least_degrees());
    texture::BakedNormalMap baked = baker.bake(least.of_few, least_degrees());
    const bool is_largest = baked.texel > least.of_few;  // as many as a map may have
    return is_largest || baked.map_degrees <= kGoodDegrees
               ? baked
               : baker.bake(wanted(baked.map_degrees), least_degrees());
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
    TileTexture texture;
    texture.normal_map = encoded_map(baked.map, config_.normal_map.format);
    texture.corners = std::move(baked.corners);
    texture.tangents = std::move(baked.tangents);
    return texture;
  }

  const Forest& forest_;
  TextureStore& textures_;
  const config::Config& config_;
  const JobSize& job_;
  const int end_;
  const std::uint32_t side_;
  execution::MemoryGate gate_;
};

int depth_of(const TilePopulation& tiles) {
  return tiles.levels - 1;
}

/// Returns how many tiles have maps, or are looked at for one.
double mapped_tiles(const JobSize& job, const TilePopulation& tiles) {
  const int mapped = mapped_levels(depth_of(tiles), job);
  return mapped < depth_of(tiles) ? std::ldexp(1.0, mapped) - 1
                                  : tiles.simplified.count - tiles.early.count;
}

/// Returns them as a part of all simplified tiles.
double mapped_part(const JobSize& job, const TilePopulation& tiles) {
  return mapped_tiles(job, tiles) / std::max(1.0, tiles.simplified.count);
}

/// Returns the texels of all maps: three levels above the partitions have about as many as the
/// original's vertices ask for, the others as many as a map may have, and those under pictures,
/// too.
double map_texels(const JobSize& job, const TilePopulation& tiles) {
  const double side = job.normal_map_side;
  if (job.textured)
    return mapped_tiles(job, tiles) * side * side;
  const double vertices = tiles.partitions.vertices / std::max(1.0, tiles.partitions.count);
  constexpr double kShown = 0.4, kUsualTexelsAVertex = kMostTexelsAVertex;
  double texels = 0, left = mapped_tiles(job, tiles);
  const int unmapped = depth_of(tiles) - mapped_levels(depth_of(tiles), job);
  for (double below = std::ldexp(1.0, unmapped + 1); left > 0.5; below *= 2) {
    const double on_level = std::min(left, std::ceil(left / 2));
    texels += on_level * std::min(side * side, below * vertices * kUsualTexelsAVertex / kShown);
    left -= on_level;
  }
  return texels;
}

}  // namespace

float finest_map_texel(const Forest& forest, NodeId node, const BakeSource& source) {
  return texel_for(source,
                   kMostTexelsAVertex * static_cast<double>(forest.tree().ranks(node).size()));
}

TileImage encoded_map(const images::Image& map, const NormalMapFormat& format) {
  return {format.format, AlphaMode::opaque, map.width, map.height,
          images::encode_normal_map(map, format)};
}

std::uint64_t map_bytes(std::uint32_t side) {
  constexpr double kSources = 16;
  constexpr double kShown = 0.45;  // so much of a picture's texels is covered
  constexpr double kDirections = kSources * kShown * sizeof(texture::NormalTexel);
  return texel_bytes(side) + static_cast<std::uint64_t>(kDirections * side * side);
}

void make_normal_maps(const Forest& forest, TextureStore& textures, BuildJournal& journal,
                      const LevelRange& levels, const StageContext& context) {
  const int mapped = mapped_levels(raw(context.tree().depth()), context.plan.job);
  const int end = std::min(levels.end, mapped);
  MapStage stage(forest, textures, mapped, context);
  make_level_by_level("normal maps", {levels.top, end, levels.share}, textures, journal, context,
                      [&](NodeId node) { stage.make(node); });
}

StageMemory normal_map_memory(const JobSize& job) {
  std::uint64_t largest = map_bytes(job.normal_map_side);
  if (job.unmapped_levels > 0)
    largest = std::max(largest, first_map_bytes(job));
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
  return map_texels(job, tiles) * texel +
         mapped_part(job, tiles) * tiles.simplified.vertices * kVertex;
}

double map_seconds(const JobSize& job, const TilePopulation& tiles) {
  if (job.normal_map_side == 0)
    return 0;
  constexpr double kTileSeconds = 40e-3;
  constexpr double kBakedSeconds = 220e-9;
  const double texel = kBakedSeconds + images::coders_of(job.normal_map_format).directions.seconds;
  return mapped_tiles(job, tiles) * kTileSeconds + map_texels(job, tiles) * texel;
}

StageTimes normal_map_time(const JobSize& job, const TilePopulation& tiles) {
  return {{"normal maps", "tiles", static_cast<std::uint64_t>(mapped_tiles(job, tiles)),
           map_seconds(job, tiles)}};
}

double map_scratch_bytes(const JobSize& job, const TilePopulation& tiles) {
  if (job.normal_map_side == 0)
    return 0;
  constexpr double kShown = 0.45;
  const double directions = map_texels(job, tiles) * (kShown * sizeof(texture::NormalTexel) + 0.2);
  constexpr double kTriangle =
      sizeof(TileTriangle) + 2 * sizeof(texture::CornerTexcoords) + sizeof(texture::CornerTangents);
  const double mesh =
      tiles.simplified.triangles * kTriangle + tiles.simplified.vertices * sizeof(Vec3f);
  return directions + published_map_bytes(job, tiles) + mapped_part(job, tiles) * mesh;
}

DiskVolumes normal_map_disk(const JobSize& job, const TilePopulation& tiles,
                            const MemoryPlan& /*memory*/) {
  return {{map_scratch_bytes(job, tiles), DiskMoment::simplify, DiskMoment::simplify}};
}

}  // namespace meshhier::pipeline
