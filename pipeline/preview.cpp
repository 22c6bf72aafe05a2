#include "pipeline/preview.h"

#include "hierarchy/cut.h"
#include "images/fitted.h"
#include "render/drawing_cost.h"
#include "render/painting.h"
#include "render/portrait.h"
#include "render/tile_facets.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/io/hash.h"
#include "storage/io/sealed_file.h"

#include <utility>

namespace meshhier::pipeline {
namespace {

/// A level with more triangles shows no more in so few pixels, and takes longer to draw.
constexpr std::uint64_t kMostTriangles = 60'000;

/// The same of the texels of its pictures, which are decoded a few times.
constexpr std::uint64_t kMostTexels = 2048 * 2048;

/// Large triangles may lie on each other in any number. With more samples to look at, seconds, the
/// picture is smaller.
constexpr std::uint64_t kMostSamples = std::uint64_t{1} << 28;
constexpr std::uint32_t kLeastSide = 16;

/// Of samples at a time: as many as one for each pixel, which shadows are made of.
constexpr std::uint64_t kBandBytes =
    sizeof(render::Sample) * storage::kMostPreviewSide * storage::kMostPreviewSide;
/// What is held beside a tile: samples, shadows, the picture; then what encodes it.
constexpr std::uint64_t kPaintingBytes = kBandBytes + (3 << 20);

/// Tiles draw all of their border, also what they leave to each other.
bool is_quick(const Cut& cut, std::span<const TileRecord> records) {
  std::uint64_t triangles = 0, texels = 0;
  for (const NodeId node : cut.nodes()) {
    const TileRecord& record = storage::record_of(records, node);
    triangles += std::uint64_t{record.interior_count} + record.border_count;
    texels += std::uint64_t{record.image_width} * record.image_height;
  }
  return triangles <= kMostTriangles && texels <= kMostTexels;
}

/// The finest level of those that are quick to draw, or the root.
Cut shown_cut(const Tree& tree, std::span<const TileRecord> records) {
  Cut shown = Cut::of_level(tree, Level{0});
  for (Level level{0}; level < tree.depth();) {
    level = finer(level);
    Cut next = Cut::of_level(tree, level);
    if (!is_quick(next, records))
      break;
    shown = std::move(next);
  }
  return shown;
}

PublishedTile tile_of(const PreviewInput& input, NodeId node, const StageContext& context) {
  const TileRecord& record = storage::record_of(input.records, node);
  const auto path = storage::tile_path(input.directory, record.node);
  const auto bytes = storage::read_sealed(context.files, path, {record.file_bytes, record.checksum},
                                          record.file_bytes);
  return storage::decode_tile(bytes, record.node, context.tree(), input.format, path.string());
}

/// Without its picture, which need not be decoded to see where they lie.
std::vector<render::Facet> facets_of(PublishedTile tile, const AttributeLayout& layout) {
  tile.image = {};
  return render::scene_tile(tile, layout).facets;
}

/// Tiles draw all of their border: twice what lies between two of them, and nothing is missing.
render::Scene scene_of(const PreviewInput& input, const Cut& cut, const AttributeLayout& layout,
                       const StageContext& context) {
  render::Scene scene;
  if (input.format.textures && input.format.textures->unlit)
    scene.light = render::Light::none;
  for (const NodeId node : cut.nodes())
    scene.boxes.push_back(storage::record_of(input.records, node).bounds);
  scene.load = [&input, &context, layout, nodes = cut.nodes()](std::size_t i) {
    return render::scene_tile(tile_of(input, nodes[i], context), layout);
  };
  return scene;
}

std::uint64_t samples_of(const PreviewInput& input, const Cut& cut, const AttributeLayout& layout,
                         const render::Camera& camera, const StageContext& context) {
  std::uint64_t sum = 0;
  for (const NodeId node : cut.nodes()) {
    context.cancel.check();
    sum += render::samples_to_draw(facets_of(tile_of(input, node, context), layout), camera);
  }
  return sum;
}

/// The same view, with fewer pixels if that is too much to draw.
render::Camera affordable(const render::Camera& camera, std::uint64_t samples) {
  render::Framing framing = camera.framing();
  for (; samples > kMostSamples && framing.width > kLeastSide && framing.height > kLeastSide;
       samples /= 4) {
    framing.width /= 2;
    framing.height /= 2;
  }
  return camera.with(framing);
}

}  // namespace

MadePreview make_preview(const PreviewInput& input, const StageContext& context) {
  const Tree& tree = context.tree();
  const Cut cut = shown_cut(tree, input.records);
  const Vec3d up = input.format.frame.up == UpAxis::z ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
  AttributeLayout layout = input.format.attributes;
  const render::Camera camera = [&] {
    const std::vector<render::Facet> whole = facets_of(tile_of(input, NodeId{}, context), layout);
    layout = render::drawn_layout(whole, layout);
    const render::View view = render::portrait_view(whole, up);
    return render::portrait_camera(
        whole, view,
        {.width = storage::kMostPreviewSide, .height = storage::kMostPreviewSide, .samples = 2});
  }();
  const std::uint64_t samples = samples_of(input, cut, layout, camera, context);
  images::FittedImage picture = images::encode_to_fit(
      render::paint(scene_of(input, cut, layout, context), affordable(camera, samples),
                    {.band_bytes = kBandBytes, .step = [&] { context.cancel.check(); }}),
      storage::kMostPreviewBytes);
  const storage::Preview facts{picture.width, picture.height, picture.file.size(),
                               storage::checksum(picture.file)};
  return {facts, std::move(picture.file)};
}

std::uint64_t preview_memory(const JobSize& job) {
  // A tile as it is published and decoded, and what is drawn of it.
  constexpr std::uint64_t kTriangleBytes = sizeof(render::Facet) + sizeof(render::Skin) + 40;
  return kPaintingBytes + job.part_triangles(job.largest_tile) * kTriangleBytes;
}

}  // namespace meshhier::pipeline
