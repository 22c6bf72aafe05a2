#include "storage/format/hierarchy_reader.h"

#include "base/bounds.h"
#include "base/error.h"
#include "hierarchy/cut.h"
#include "storage/format/build_name.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/format/load_manifest.h"
#include "storage/format/outline_glb.h"
#include "storage/io/sealed_file.h"

#include <algorithm>
#include <cassert>
#include <cstdint>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

/// The largest length that a GLB can state: a larger file is not worth the memory.
constexpr std::uint64_t kMaxGlbBytes = UINT32_MAX;

/// Checks that the records have splits and pictures only where the manifest says so.
void check_shading(std::span<const TileRecord> records, const Manifest& manifest,
                   const std::string& name) {
  const auto has_splits = [](const TileRecord& record) { return record.split_count > 0; };
  if (!manifest.computed_normals && !manifest.textures && !manifest.normal_maps &&
      std::ranges::any_of(records, has_splits)) {
    throw Error(ErrorCode::corrupt,
                name + ": splits without computed normals, textures or normal maps");
  }
  if (manifest.normal_maps.has_value() !=
      std::ranges::any_of(records, &TileRecord::has_normal_map)) {
    throw Error(ErrorCode::corrupt,
                name + ": normal maps are not where the manifest says that they are");
  }
  for (const TileRecord& record : records) {
    const bool has_triangles = record.interior_count > 0 || record.border_count > 0;
    if (record.has_normal_map)
      continue;
    const bool has_image = record.image_width > 0;
    if (has_image != (manifest.textures && has_triangles)) {
      throw Error(
          ErrorCode::corrupt,
          fmt::format("{}: tile {} has {} picture, but the mesh has {}", name, to_text(record.node),
                      has_image ? "a" : "no", manifest.textures ? "textures" : "no textures"));
    }
  }
}

std::vector<TileRecord> load_index(FileSystem& files, const std::filesystem::path& directory,
                                   const Manifest& manifest, const Tree& tree) {
  const auto path = index_path(directory);
  const auto bytes = of_one_build(files, directory, manifest, [&] {
    return read_sealed(files, path, {manifest.index_bytes, manifest.index_checksum},
                       index_bytes(tree));
  });
  std::vector<TileRecord> records = decode_index(bytes, tree, path.string());
  check_shading(records, manifest, path.string());
  return records;
}

/// Returns the name of the first count in which tile and record differ; null if they agree.
const char* difference(const PublishedTile& tile, const TileRecord& record) {
  const TileMesh& mesh = tile.mesh;
  if (mesh.own_count != record.own_count)
    return "own vertices";
  if (mesh.boundary_count != record.boundary_count)
    return "boundary vertices";
  if (mesh.ghosts.size() != record.ghost_count)
    return "ghosts";
  if (mesh.copies.size() != record.copy_count)
    return "copies";
  if (tile.shading.split_of.size() != record.split_count)
    return "splits";
  if (mesh.interior.size() != record.interior_count)
    return "interior triangles";
  if (mesh.border.size() != record.border_count)
    return "border triangles";
  const TileImage& image = record.has_normal_map ? tile.normal_map : tile.image;
  if (tile.normal_map.empty() == record.has_normal_map || image.width != record.image_width ||
      image.height != record.image_height)
    return "picture's sides";
  if (bounds_of(mesh.vertices.positions) != record.bounds)
    return "bounds";
  return nullptr;
}

void check_first_view(const std::optional<Standpoint>& found, const Manifest& manifest,
                      const std::string& name) {
  if (found != manifest.first_view)
    throw Error(ErrorCode::corrupt, name + ": its first view is not that of the manifest");
}

TileFormat format_of(const Manifest& manifest) {
  TileFormat format{manifest.source.attributes, manifest.tile_frame(), manifest.compression, {}};
  if (manifest.quantization)
    format.lattice = manifest.quantization->lattice;
  format.computed_normals = manifest.computed_normals;
  format.textures = manifest.textures;
  format.screen_colours = manifest.screen_colours;
  format.normal_maps = manifest.normal_maps;
  if (manifest.objects && manifest.objects->are_in_tiles)
    format.objects = manifest.objects->table.properties;
  return format;
}

}  // namespace

HierarchyReader::HierarchyReader(FileSystem& files, std::filesystem::path directory)
    : files_(files),
      directory_(std::move(directory)),
      manifest_(load_manifest(files_, directory_)),
      tree_(manifest_.source.places, manifest_.partition_count),
      format_(format_of(manifest_)),
      records_(load_index(files_, directory_, manifest_, tree_)) {}

const TileRecord& HierarchyReader::record(NodeId node) const {
  assert(tree_.contains(node));
  return record_of(records_, tree_.tile_node(node));
}

void HierarchyReader::will_read(std::span<const NodeId> nodes) const {
  std::vector<std::filesystem::path> paths;
  paths.reserve(nodes.size());
  for (const NodeId node : nodes)
    paths.push_back(tile_path(directory_, record(node).node));
  files_.will_read(paths);
}

PublishedTile HierarchyReader::read_tile(NodeId node) const {
  const TileRecord& expected = record(node);
  const auto path = tile_path(directory_, expected.node);
  const auto bytes = of_one_build(files_, directory_, manifest_, [&] {
    return read_sealed(files_, path, {expected.file_bytes, expected.checksum}, kMaxGlbBytes);
  });
  PublishedTile tile = decode_tile(bytes, expected.node, tree_, format_, path.string());
  if (const char* what = difference(tile, expected)) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: its {} are not those of the index", path.string(), what));
  }
  if (tile.node == tree_.root())
    check_first_view(tile.first_view, manifest_, path.string());
  return tile;
}

Outline HierarchyReader::read_outline() const {
  const auto path = outline_path(directory_);
  const auto bytes = of_one_build(files_, directory_, manifest_, [&] {
    return read_sealed(files_, path, {manifest_.outline_bytes, manifest_.outline_checksum},
                       kMaxGlbBytes);
  });
  Outline outline = decode_outline(bytes, path.string());
  check_first_view(outline.first_view, manifest_, path.string());
  return outline;
}

std::unique_ptr<ObjectTable> HierarchyReader::open_objects() const {
  if (!manifest_.objects) {
    throw Error(ErrorCode::usage,
                fmt::format("{}: has no objects; \"objects\" of the config says what they are made "
                            "of",
                            directory_.string()));
  }
  return of_one_build(files_, directory_, manifest_, [&] {
    return std::make_unique<ObjectTable>(files_.open(objects_path(directory_)),
                                         &manifest_.objects->table);
  });
}

std::vector<std::byte> HierarchyReader::read_preview() const {
  assert(manifest_.preview);
  return of_one_build(files_, directory_, manifest_, [&] {
    return read_sealed(files_, preview_path(directory_),
                       {manifest_.preview->bytes, manifest_.preview->checksum}, kMostPreviewBytes);
  });
}

}  // namespace meshhier::storage
