#include "mesh_io/tileset.h"

#include "mesh_io/tileset_tree.h"

#include <algorithm>
#include <cmath>

namespace meshhier::mesh_io {
namespace {

/// The largest radius of a volume whose middle tells where its content is: within it the ground
/// leaves its tangent plane by 800 m.
constexpr double kLocalRadius = 100'000;

double largest_scale(const GltfTransform& t) {
  double largest = 0;
  for (const Vec3d& row : t.rows)
    largest = std::max(largest, length(row));
  return largest * std::sqrt(3.0);
}

struct Ball {
  Vec3d middle;  ///< geocentric, if the tileset is on the globe
  double radius = 0;
  bool is_local() const { return radius <= kLocalRadius; }
};

Ball ball_of(const TileVolume& volume, const GltfTransform& to_globe) {
  if (volume.is_geocentric)
    return {volume.middle, volume.radius};
  return {transformed(to_globe, volume.middle), volume.radius * largest_scale(to_globe)};
}

/// Returns where on the globe a content is.
std::optional<Vec3d> place_of(const ShownContent& shown) {
  std::optional<Ball> ball;
  if (shown.tile.volume)
    ball = ball_of(*shown.tile.volume, shown.to_globe);
  if (ball && ball->is_local() && is_on_globe(ball->middle))
    return ball->middle;
  for (const TileGltf& gltf : shown.content.tile.meshes) {
    const Vec3d centre = transformed(shown.to_globe, gltf.centre);
    if (is_on_globe(centre))
      return centre;
  }
  if (ball && is_on_globe(ball->middle))
    return ball->middle;
  return std::nullopt;
}

/// Returns the frame amid the tiles that are shown.
std::optional<GlobeFrame> frame_of_contents(const TilesetTree& tree) {
  std::vector<Vec3d> places;
  std::optional<GltfTransform> first;
  bool is_one = true;
  tree.for_each(
      std::nullopt,
      [&](const ShownContent& shown) {
        const auto place = place_of(shown);
        if (!place)
          return;
        places.push_back(*place);
        if (!first)
          first = shown.to_globe;
        is_one = is_one && shown.to_globe == *first;
      },
      [] {});
  if (places.empty())
    return std::nullopt;
  if (is_one && is_local_frame(*first))
    return GlobeFrame{*first};
  return frame_amid(places);
}

/// The frame as far as the root tells it.
struct RootFrame {
  bool is_known = false;  ///< if not, its tiles must be asked
  std::optional<GlobeFrame> frame{};
};

RootFrame frame_of_root(const TilesetDocument& document) {
  const TilesetTile& root = document.tiles[0];
  if (const GltfTransform from = from_input(document); is_local_frame(from))
    return {true, GlobeFrame{from}};
  if (!root.volume)
    return {};
  const Ball ball = ball_of(*root.volume, root.transform);
  if (!ball.is_local())
    return {};
  return {true, is_on_globe(ball.middle) ? std::optional(frame_at(ball.middle)) : std::nullopt};
}

std::optional<GlobeFrame> frame_of(const TilesetTree& tree) {
  const RootFrame said = frame_of_root(tree.root());
  return said.is_known ? said.frame : frame_of_contents(tree);
}

void add_meshes(const ShownContent& shown, Tileset& to) {
  const TileFile& tile = shown.content.tile;
  to.instanced += tile.instanced;
  to.points += tile.points;
  to.vectors += tile.vectors;
  for (const TileGltf& gltf : tile.meshes) {
    GltfTransform moved;
    moved.offset = gltf.centre;
    to.meshes.push_back({shown.content.file,
                         {gltf.kind, tile.is_packed},
                         gltf.offset,
                         gltf.bytes,
                         shown.placement * moved * shown.axes,
                         gltf.outline,
                         shown.content.data,
                         gltf.batch});
  }
}

}  // namespace

std::optional<GlobeFrame> globe_frame(storage::FileSystem& files, const std::filesystem::path& path,
                                      const TilesetRoom& room) {
  const TilesetDocument document = read_tileset_document(*files.open(path), room.json_bytes);
  if (const RootFrame said = frame_of_root(document); said.is_known)
    return said.frame;
  return frame_of(TilesetTree(files, path, room));
}

Tileset read_tileset(storage::FileSystem& files, const std::filesystem::path& path,
                     const std::optional<GlobeFrame>* frame, const TilesetRoom& room) {
  const TilesetTree tree(files, path, room);
  Tileset found;
  found.documents = tree.external();
  found.is_hierarchy = tree.root().is_hierarchy;
  found.frame = frame != nullptr ? *frame : frame_of(tree);
  tree.for_each(
      found.frame, [&](const ShownContent& shown) { add_meshes(shown, found); },
      [&] { ++found.coarser; });
  return found;
}

}  // namespace meshhier::mesh_io
