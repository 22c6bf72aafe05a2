#include "pipeline/texture_stage.h"

#include "base/plain_text.h"
#include "execution/memory_gate.h"
#include "hierarchy/vertex_numbers.h"
#include "images/formats.h"
#include "images/image_codec.h"
#include "images/row_writer.h"
#include "pipeline/normal_map_stage.h"
#include "pipeline/picture_levels.h"
#include "pipeline/plan/tile_room.h"
#include "pipeline/tiles/finer_surfaces.h"
#include "pipeline/tiles/tile_normals.h"
#include "pipeline/tiles/vertex_order.h"
#include "texture/charted_tile.h"
#include "texture/leaf_atlas.h"
#include "texture/reduction.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

using images::Image;
using images::Material;

/// Returns what interior triangles have, then what border ones have.
template <class T>
std::vector<T> joined(std::vector<T> interior, std::span<const T> border) {
  interior.insert(interior.end(), border.begin(), border.end());
  return interior;
}

// ---- partitions ----------------------------------------------------------------------------

/// The texture coordinates and materials of a partition's vertices, copies last, and its triangles
/// by vertices' numbers.
struct LeafCorners {
  std::vector<Vec2f> texcoords;
  std::vector<std::uint32_t> materials;
  std::vector<TileTriangle> triangles;
};

void append_corners(const VertexArray& vertices, const AttributeLayout& layout, LeafCorners& to) {
  const auto texcoord = layout.part(AttributeKind::texcoords).first;
  const auto material = layout.part(AttributeKind::material).first;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::span<const float> a = vertices.attributes_of(i);
    to.texcoords.push_back({a[texcoord], a[texcoord + 1]});
    to.materials.push_back(static_cast<std::uint32_t>(a[material]));
  }
}

LeafCorners corners_of(const TileMesh& mesh, const AttributeLayout& layout) {
  LeafCorners corners;
  append_corners(mesh.vertices, layout, corners);
  append_corners(mesh.copies.vertices, layout, corners);
  const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places);
  const std::vector<TileTriangle> border = numbers.numbered(mesh.border, mesh.border_wedges);
  corners.triangles = joined(numbers.numbered(mesh.interior, mesh.interior_wedges),
                             std::span<const TileTriangle>(border));
  return corners;
}

texture::AtlasMaterial texels_of(const Material& material, const images::ImageStore& pictures) {
  if (!material.image)
    return {};
  const images::ImageInfo& info = pictures.info(*material.image);
  return {info.width, info.height, pictures.levels(*material.image), material.wrap_u,
          material.wrap_v};
}

std::vector<texture::AtlasMaterial> texels_of(const TexturedInput& input) {
  std::vector<texture::AtlasMaterial> all;
  for (const Material& material : input.materials.materials)
    all.push_back(texels_of(material, input.pictures));
  return all;
}

/// Returns the factor by which a partition's picture is reduced to be baked from. It keeps at least
/// the texels that the tile above has for it, which saves reducing it again for each tile that is
/// baked from it.
std::uint32_t reduction(std::uint64_t texels, std::uint32_t side) {
  const std::uint64_t wanted = std::uint64_t{side} * side / 2;
  std::uint32_t factor = 1;
  while (factor < texture::kLeafAlignment &&
         texels / (4 * std::uint64_t{factor} * factor) >= wanted)
    factor *= 2;
  return factor;
}

/// Makes that picture from the bands of the partition's.
class SourcePicture {
 public:
  SourcePicture(const images::WrittenImage& whole,
                std::span<const texture::CornerTexcoords> corners, std::uint32_t side) {
    const std::uint32_t factor = reduction(std::uint64_t{whole.width} * whole.height, side);
    if (factor > 1)
      reduction_.emplace(whole.width, whole.height, whole.channels, corners, factor);
    else
      image_ = Image(whole.width, whole.height, whole.channels);
  }

  void add(const Image& band) {
    if (reduction_)
      reduction_->add(band);
    else
      std::ranges::copy(band.texels, image_.at(0, rows_));
    rows_ += band.height;
  }
  Image take() && { return reduction_ ? (*std::move(reduction_))() : std::move(image_); }

 private:
  std::optional<texture::Reduction> reduction_;
  Image image_;  ///< unless it is reduced
  std::uint32_t rows_ = 0;
};

// ---- all tiles -----------------------------------------------------------------------------

/// Returns the largest side of a partition's picture: a picture of the input of 4,096 texels with
/// the gutter around it, or the format's most, if that is less (for KTX2 half of it). Where the
/// input has more texels, as with pictures that repeat, a coarser level of them is shown, with a
/// warning.
std::uint32_t leaf_side(ImageFormat format) {
  constexpr std::uint32_t kLeafSide = 4096 + 2 * texture::kLeafGutter;
  return std::min(kLeafSide, images::coders_of(format).most_side);
}

/// Memory of a triangle at work: its corners, positions, and coordinates before and after.
constexpr std::uint64_t kTriangleBytes = 300;

/// Returns the memory of a partition's picture at work: a band of it, the encoder and its output,
/// twice, and the smaller picture that others are baked from.
std::uint64_t cut_bytes(const images::WrittenImage& picture, std::uint32_t side) {
  const std::uint64_t texels = std::uint64_t{picture.width} * picture.height;
  const std::uint64_t encoded = is_exact(picture.format, picture.quality) ? 4 : 1;
  const std::uint64_t factor = reduction(texels, side);
  return LeafPicture::bytes(picture.width, picture.height) + images::held_bytes(picture) +
         texels * encoded + texture::Reduction::bytes(texels, texels / (factor * factor));
}

/// Returns the memory of a simplified tile's picture, and of the finer ones that it is baked from;
/// and of its normal map.
std::uint64_t bake_bytes(const JobSize& job) {
  constexpr std::uint64_t kBakedBytes = 64;
  constexpr std::uint64_t kSources = 16;
  constexpr std::uint64_t kSourceTexels = 2;
  const std::uint64_t texels = std::uint64_t{job.picture_side} * job.picture_side;
  return texels * (kBakedBytes + kSources * kSourceTexels * 3) +
         images::coder_bytes(job.pictures, texels) +
         (job.has_relief() ? map_bytes(job.normal_map_side) : 0);
}

float root_of_squares(double a, double b) {
  return static_cast<float>(std::sqrt(a * a + b * b));
}

class TextureMaker {
 public:
  TextureMaker(const Forest& forest, const TexturedInput& input, TextureStore& textures,
               const StageContext& context)
      : forest_(forest),
        input_(input),
        materials_(texels_of(input)),
        textures_(textures),
        config_(context.config),
        job_(context.plan.job),
        format_(job_.pictures),
        side_(context.config.texture.texels / texture::kBakeAlignment * texture::kBakeAlignment),
        gate_(picture_room_bytes(context.memory().work_bytes)) {}

  void make(NodeId node) {
    if (forest_.tree().is_partition(node))
      cut(node);
    else
      bake(node);
  }

  /// Returns one line on texels that partitions do not show; empty if there are none.
  std::string warning() const {
    if (reduced_ == 0)
      return {};
    return fmt::format(
        "{} of the partitions show their pictures by up to {} times fewer texels a side than the "
        "input has: their pictures are larger than those of partitions may be ({} a side), or "
        "repeat many times over few triangles; smaller partitions (\"partition.vertices\") lose "
        "less, unless a single triangle shows so much",
        counted(reduced_, "triangles"), std::uint64_t{1} << coarsest_level_,
        leaf_side(format_.format));
  }

 private:
  /// Makes the picture of a partition.
  void cut(NodeId node) {
    TileMesh mesh = forest_.load(node).mesh;
    std::vector<std::uint16_t> parents = forest_.published_parent_map(node);
    order_inner_vertices(mesh, parents);
    const LeafCorners leaf = corners_of(mesh, forest_.layout(node.level));
    texture::LeafAtlas atlas = texture::plan_leaf_atlas(
        {leaf.triangles, leaf.texcoords, leaf.materials}, materials_, leaf_side(format_.format));
    note_reduced(atlas);
    BakeSource source = bare_source(mesh, std::move(parents));
    source.corners = std::move(atlas.corners);
    if (atlas.pieces.empty()) {
      textures_.put(node, {}, std::move(source), {});
      return;
    }
    const LeafPicture picture(atlas, source.corners, input_);
    source.alpha = picture.alpha();
    const images::WrittenImage written = written_as(source.alpha, atlas.width, atlas.height);
    // The size of a picture is known only now: tiles wait here until there is memory for theirs.
    const execution::MemoryGate::Hold held = gate_.enter(cut_bytes(written, side_));
    const TileTexture texture = painted(picture, written, source);
    const float texel = texture::texel_size(source.surface(), atlas.width, atlas.height);
    textures_.put(node, texture, std::move(source), {texel, texel, 0});
  }

  void note_reduced(const texture::LeafAtlas& atlas) {
    reduced_ += atlas.reduced;
    std::uint32_t level = coarsest_level_;
    for (const texture::AtlasPiece& piece : atlas.pieces) {
      while (piece.level > level && !coarsest_level_.compare_exchange_weak(level, piece.level)) {
      }
    }
  }

  /// Encodes the picture, and gives the source a smaller one.
  TileTexture painted(const LeafPicture& picture, const images::WrittenImage& written,
                      BakeSource& source) const {
    TileTexture texture{tile_image(written, source.alpha), source.corners};
    // Reserved address space takes no memory yet, and the bytes need not move while they grow.
    texture.image.bytes.reserve(std::size_t{written.width} * written.height);
    const auto writer = images::open_picture_writer(written, [&](std::span<const std::byte> bytes) {
      texture.image.bytes.insert(texture.image.bytes.end(), bytes.begin(), bytes.end());
    });
    SourcePicture smaller(written, source.corners, side_);
    for (std::uint32_t top = 0; top < written.height;) {
      const Image band = picture.band(top);
      for (std::uint32_t y = 0; y < band.height; ++y)
        writer->write_row(band.at(0, y));
      smaller.add(band);
      top += band.height;
    }
    writer->finish();
    source.image = std::move(smaller).take();
    return texture;
  }

  void bake(NodeId node) {
    const TileMesh mesh = forest_.load(node).mesh;
    BakeSource source = bare_source(mesh, forest_.published_parent_map(node));
    TexelSizes texels = texels_below(node);
    const execution::MemoryGate::Hold held = gate_.enter(bake_bytes(job_));
    TileTexture texture;
    if (!source.triangles.empty()) {
      const std::vector<FinerSurface> finer =
          finer_surfaces(forest_, node, meshhier::finer(node.level), mesh,
                         [&](NodeId child) { return finer_source(child); });
      std::vector<texture::FinerShape> shapes;
      for (const FinerSurface& one : finer)
        shapes.push_back(one.shape());
      const texture::ChartedTile charts({source.positions, source.triangles, {}, nullptr},
                                        {side_, least_texel(node, source, texels.finest)},
                                        std::move(shapes));
      texels.lost = root_of_squares(texels.lost, add_picture(charts, finer, source));
      texture = encoded(source);
      if (job_.has_relief())
        add_normal_map(charts, finer, normals_of(node, mesh), source, texture);
    }
    texels.own = texel_of(source);
    textures_.put(node, texture, std::move(source), texels);
  }

  std::vector<texture::CornerNormals> normals_of(NodeId node, const TileMesh& mesh) const {
    return corner_normals(mesh, forest_.layout(node.level), computed_shading(forest_, node, mesh));
  }

  /// Returns the surface of a tile; that of a partition has its normals if a map is made of them.
  std::shared_ptr<const BakeSource> finer_source(NodeId tile) const {
    if (!job_.has_relief() || !forest_.tree().is_partition(tile))
      return textures_.source(tile);
    return textures_.source(tile, [&] {
      BakeSource source = textures_.read_source(tile);
      const OrderedTile ordered = ordered_tile(forest_, tile, forest_.load(tile).mesh);
      source.normals = corner_normals(ordered.mesh, forest_.layout(tile.level), ordered.shading);
      return source;
    });
  }

  /// Returns how small texels may be: as the finest ones below, and as a normal map asks for.
  float least_texel(NodeId node, const BakeSource& source, float finest) const {
    return job_.has_relief() ? std::min(finest, finest_map_texel(forest_, node, source)) : finest;
  }

  /// Returns what it lost.
  static float add_picture(const texture::ChartedTile& charts,
                           const std::vector<FinerSurface>& finer, BakeSource& source) {
    std::vector<texture::TexturedSurface> surfaces;
    for (const FinerSurface& one : finer) {
      surfaces.push_back(one.surface());
      source.alpha = std::max(source.alpha, one.source->alpha);
    }
    texture::BakedTexture baked = texture::bake(charts, surfaces);
    source.image = std::move(baked.image);
    source.corners = std::move(baked.corners);
    return baked.lost;
  }

  void add_normal_map(const texture::ChartedTile& charts, const std::vector<FinerSurface>& finer,
                      const std::vector<texture::CornerNormals>& normals, BakeSource& source,
                      TileTexture& texture) const {
    std::vector<texture::NormalSurface> surfaces;
    for (const FinerSurface& one : finer)
      surfaces.push_back(one.normal_surface());
    texture::BakedNormalMap baked = texture::bake_normal_map(charts, normals, surfaces);
    source.directions = std::move(baked.texels);
    texture.normal_map = encoded_map(baked.map, config_.normal_map.format);
    texture.tangents = std::move(baked.tangents);
  }

  images::WrittenImage written_as(AlphaMode alpha, std::uint32_t width,
                                  std::uint32_t height) const {
    return {stored_format(format_, alpha), format_.quality, width, height,
            alpha == AlphaMode::opaque ? 3U : 4U};
  }
  static TileImage tile_image(const images::WrittenImage& written, AlphaMode alpha) {
    return {written.format, alpha, written.width, written.height, {}};
  }

  TileTexture encoded(const BakeSource& source) const {
    const AlphaMode alpha = source.image.channels == 3 ? AlphaMode::opaque : source.alpha;
    const images::WrittenImage written = written_as(alpha, source.image.width, source.image.height);
    TileTexture texture{tile_image(written, alpha), source.corners};
    texture.image.bytes = images::encode_image(source.image, written.format, written.quality);
    return texture;
  }

  static float texel_of(const BakeSource& source) {
    return texture::texel_size(source.surface(), source.image.width, source.image.height);
  }

  /// Returns the finest texels of the children, and the root mean square of what they have lost.
  TexelSizes texels_below(NodeId node) const {
    TexelSizes below;
    double squares = 0;
    const Tree::Children children = forest_.tree().children(node);
    for (const NodeId child : children.span()) {
      const TexelSizes& texels = textures_.texels(forest_.tree().tile_node(child));
      if (texels.finest > 0 && (below.finest == 0 || texels.finest < below.finest))
        below.finest = texels.finest;
      squares += double(texels.lost) * texels.lost;
    }
    below.lost =
        static_cast<float>(std::sqrt(squares / static_cast<double>(children.span().size())));
    return below;
  }

  const Forest& forest_;
  const TexturedInput& input_;
  const std::vector<texture::AtlasMaterial> materials_;
  TextureStore& textures_;
  const config::Config& config_;
  const JobSize& job_;
  const TextureFormat format_;
  const std::uint32_t side_;
  execution::MemoryGate gate_;
  std::atomic<std::uint64_t> reduced_ = 0;  ///< triangles that a coarser level of a picture shows
  std::atomic<std::uint32_t> coarsest_level_ = 0;
};

}  // namespace

void make_textures(const Forest& forest, const TexturedInput& input, TextureStore& textures,
                   BuildJournal& journal, const LevelRange& levels, const StageContext& context) {
  TextureMaker maker(forest, input, textures, context);
  make_level_by_level("texture", levels, textures, journal, context,
                      [&](NodeId node) { maker.make(node); });
  if (const std::string warning = maker.warning(); !warning.empty())
    context.progress.warn(warning);
}

TileErrors with_texels(TileErrors errors, const Tree& tree, const TextureStore& textures) {
  const std::vector<NodeId> nodes = tree.tile_nodes();
  // The finest come first: a tile's parent stands before it in the list.
  for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
    TileError& own = errors[*node];
    const TexelSizes& texels = textures.texels(*node);
    if (!tree.is_partition(*node) && std::max(texels.own, texels.lost) > texels.finest)
      own.error = std::max({own.error, texels.own, texels.lost});
    if (node->level == Level{0})
      continue;
    // Errors must still grow strictly towards the root.
    TileError& parent = errors[tree.parent_tile(*node)];
    if (parent.error <= own.error)
      parent.error = std::nextafter(own.error, std::numeric_limits<float>::infinity());
  }
  return errors;
}

StageMemory texture_memory(const JobSize& job) {
  const images::WrittenImage leaf{stored_format(job.pictures, job.alpha), job.pictures.quality,
                                  leaf_side(job.pictures.format), leaf_side(job.pictures.format),
                                  4};
  const std::uint64_t largest = std::max(cut_bytes(leaf, job.picture_side), bake_bytes(job));
  // Items that wait for room have their geometry: read, ordered, cut into charts.
  const std::uint64_t waiting = (job.threads + 1) * job.part_triangles(job.largest_tile) *
                                (job.has_relief() ? kFramedTriangleBytes : kTriangleBytes);
  return {largest, job.threads + 1, 2 * kLeastPictureCache + waiting + largest,
          2 * kMostPictureCache + waiting + (job.threads + 1) * largest};
}

StageTimes texture_time(const JobSize& job, const TilePopulation& tiles) {
  constexpr double kTexelSeconds = 60e-9;
  constexpr double kBakedSeconds = 500e-9;
  const double side = job.picture_side;
  const double coded = images::costs_of(job.pictures).seconds;
  return {{"texture", "tiles",
           static_cast<std::uint64_t>(tiles.partitions.count + tiles.simplified.count -
                                      tiles.early.count),
           static_cast<double>(job.source_texels) * (kTexelSeconds + coded) +
               tiles.simplified.count * side * side * (kBakedSeconds + coded) +
               map_seconds(job, tiles)}};
}

double published_picture_bytes(const JobSize& job, const TilePopulation& tiles) {
  if (!job.textured)
    return 0;
  // Most of an atlas is covered, and little of the input's pictures is not.
  const double texel = images::costs_of(job.pictures).file_bytes;
  const double baked = (tiles.simplified.count - tiles.early.count) *
                       static_cast<double>(job.picture_side) * job.picture_side;
  return (static_cast<double>(job.source_texels) * 0.8 + baked) * texel;
}

DiskVolumes texture_disk(const JobSize& job, const TilePopulation& tiles,
                         const MemoryPlan& /*memory*/) {
  const double side = job.picture_side;
  // The reduced picture of a partition has up to twice the texels of a simplified tile's picture,
  // and no more than it shows.
  const double cut = std::min(tiles.partitions.count * 2 * side * side,
                              static_cast<double>(job.source_texels) * 1.3);
  const double pictures =
      (tiles.simplified.count * side * side + cut) * 3 + published_picture_bytes(job, tiles);
  const double triangles = tiles.partitions.triangles + tiles.simplified.triangles;
  constexpr double kTriangle = 3 * sizeof(Vec2f) * 2 + 12 + 6;
  return {{pictures + triangles * kTriangle + map_scratch_bytes(job, tiles), DiskMoment::simplify,
           DiskMoment::simplify}};
}

}  // namespace meshhier::pipeline
