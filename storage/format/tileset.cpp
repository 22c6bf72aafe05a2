#include "storage/format/tileset.h"

#include "base/angle.h"
#include "base/wgs84.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/format/sealed_json.h"
#include "storage/format/tile_values.h"
#include "storage/io/hash.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

/// No axis of a box is shorter than this part of the model, as viewers divide by their lengths.
constexpr double kThinnest = 1e-6;

/// The boxes that hold a node's tile and all below it, relative to the origin.
class Boxes {
 public:
  Boxes(const Tree& tree, std::span<const TileRecord> records)
      : tree_(tree), levels_(raw(tree.depth()) + std::size_t{1}) {
    for (int level = 0; level <= raw(tree.depth()); ++level)
      levels_[level].resize(tree.node_count(static_cast<Level>(level)));
    for (std::size_t i = records.size(); i-- > 0;) {  // children first
      const NodeId node = records[i].node;
      at(node).add(records[i].bounds);
      if (node.level > Level{0})
        at(tree_.parent_tile(node)).add(at(node));
    }
  }
  const Bounds& operator[](NodeId node) const { return levels_[raw(node.level)][node.index]; }

 private:
  Bounds& at(NodeId node) { return levels_[raw(node.level)][node.index]; }

  const Tree& tree_;
  std::vector<std::vector<Bounds>> levels_;
};

/// Returns how many times longer a transform makes a line along an axis, at most; 1 if it is nearly
/// that, as it is with maps and rounded turns.
double largest_scale(const Transform& m) {
  constexpr double kNearlyOne = 0.01;
  double largest = 0;
  for (std::size_t column = 0; column < 12; column += 4)
    largest = std::max(largest, length(Vec3d{m[column], m[column + 1], m[column + 2]}));
  return std::abs(largest - 1) < kNearlyOne ? 1 : largest;
}

class TilesetWriter {
 public:
  TilesetWriter(const Manifest& manifest, const Tree& tree, std::span<const TileRecord> records)
      : manifest_(manifest), tree_(tree), records_(records), boxes_(tree, records) {
    const Bounds& all = boxes_[tree.root()];
    thinnest_ = kThinnest * diagonal(all);
    const int levels = raw(tree.depth()) + 1;
    const int files = (levels + kTilesetLevels - 1) / kTilesetLevels;
    levels_per_file_ = (levels + files - 1) / files;
  }

  void write(const std::function<void(const TilesetFile&)>& visit) const {
    visit({tileset_path({}), text_of(tree_.root())});
    for (int level = levels_per_file_; level <= raw(tree_.depth()); level += levels_per_file_) {
      for (std::uint32_t i = 0; i < tree_.node_count(static_cast<Level>(level)); ++i) {
        const NodeId node{static_cast<Level>(level), i};
        if (is_page(node))
          visit({tileset_path({}, node), text_of(node)});
      }
    }
  }

 private:
  /// Whether a node has a file of its own.
  bool is_page(NodeId node) const {
    return raw(node.level) > 0 && raw(node.level) % levels_per_file_ == 0 &&
           !tree_.is_partition(tree_.tile_node(node));
  }

  /// The pixels of error that viewers allow by default; geometric errors are multiplied by them.
  double pixels() const { return manifest_.tileset_pixels.value_or(1); }

  const TileRecord& record(NodeId node) const { return record_of(records_, node); }

  std::string text_of(NodeId root) const {
    const bool is_first = root == tree_.root();
    Json document;
    document["asset"] = {{"version", "1.1"}};
    if (is_first) {
      document["asset"]["extras"] = {{"generator", manifest_.generator}};
      describe_source(document);
    }
    // The error while nothing is drawn. It is in metres, as no transform is above it.
    const std::optional<Transform> transform = manifest_.root_transform();
    const double error = std::max(diagonal(boxes_[root]), 2.0 * record(root).error);
    document["geometricError"] = pixels() * error * (transform ? largest_scale(*transform) : 1);
    document["root"] = tile_json(root, root);
    if (is_first && transform)
      document["root"]["transform"] = *transform;
    return json_text(document) + '\n';
  }

  void describe_source(Json& document) const {
    const SourceSummary& source = manifest_.source;
    const auto count = [] { return Json{{"type", "SCALAR"}, {"componentType", "UINT64"}}; };
    Json properties = {
        {"name", {{"type", "STRING"}}}, {"vertices", count()}, {"triangles", count()}};
    Json values = {
        {"name", source.file_name}, {"vertices", source.vertices}, {"triangles", source.triangles}};
    if (!manifest_.licence.empty()) {
      properties["licence"] = {{"type", "STRING"}};
      values["licence"] = manifest_.licence;
    }
    document["schema"] = {{"id", "meshhier"},
                          {"classes", {{"source", {{"properties", std::move(properties)}}}}}};
    if (!source.attributes.values.empty())
      describe_values(document);
    document["metadata"] = {{"class", "source"}, {"properties", std::move(values)}};
  }

  /// Adds the class of the tiles' vertices, and the ranges of the input's values.
  void describe_values(Json& document) const {
    const SourceSummary& source = manifest_.source;
    const std::vector<std::string> ids = value_ids(source.attributes);
    document["schema"]["classes"]["vertex"] = vertex_class(source.attributes);
    Json& statistics = document["statistics"]["classes"]["vertex"];
    statistics["count"] = source.vertices;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const ValueStatistics& value = source.values[i];
      statistics["properties"][ids[i]] = {{"min", value.min},
                                          {"max", value.max},
                                          {"extras",
                                           {{"missing", value.missing},
                                            {"bin_width", std::ldexp(1.0, value.bin_exponent)},
                                            {"first_bin", value.first_bin},
                                            {"bins", value.bins}}}};
    }
  }

  /// Returns a node's object with those below it. `root`: the root of the file it is written into.
  Json tile_json(NodeId node, NodeId root) const {
    const bool is_root = node == tree_.root();
    const std::string up = root == tree_.root() ? "" : "../../";
    Json tile;
    tile["boundingVolume"] = {{"box", box_json(boxes_[node])}};
    if (node != root && is_page(node)) {
      // This tile is never shown. Errors must decrease strictly on the way to the one it leads to.
      const double above = record(tree_.parent_tile(node)).error;
      tile["geometricError"] = pixels() * ((above + record(node).error) / 2);
      tile["content"] = {{"uri", up + tileset_path({}, node).generic_string()}};
      return tile;
    }
    tile["geometricError"] = pixels() * record(node).error;
    if (node == root)
      tile["refine"] = "REPLACE";
    tile["content"] = {{"uri", up + tile_path({}, node).generic_string()}};
    if (manifest_.tileset_pixels)
      tile["extras"]["error"] = record(node).error;
    if (is_root && manifest_.origin != manifest_.tile_frame().origin)
      tile["extras"]["origin"] = point_json(to_z_up(manifest_.origin, manifest_.up) + Vec3d{});
    const Tree::Children children = tree_.children(node);
    for (const NodeId child : children.span())
      tile["children"].push_back(tile_json(tree_.tile_node(child), root));
    return tile;
  }

  Json box_json(const Bounds& bounds) const {
    const Vec3d origin = manifest_.tile_frame().origin;
    const Vec3d low = to_double(bounds.min) + origin;
    const Vec3d high = to_double(bounds.max) + origin;
    const Vec3d centre = to_z_up((low + high) * 0.5, manifest_.up);
    const Vec3d extent = to_z_up((high - low) * 0.5, manifest_.up);
    const auto half = [&](double x) { return std::max(std::abs(x), thinnest_); };
    return {centre.x, centre.y, centre.z, half(extent.x), 0, 0, 0, half(extent.y),
            0,        0,        0,        half(extent.z)};
  }

  const Manifest& manifest_;
  const Tree& tree_;
  std::span<const TileRecord> records_;
  Boxes boxes_;
  double thinnest_ = 0;
  int levels_per_file_ = kTilesetLevels;
};

}  // namespace

void for_each_tileset(const Manifest& manifest, const Tree& tree,
                      std::span<const TileRecord> records,
                      const std::function<void(const TilesetFile&)>& visit) {
  TilesetWriter(manifest, tree, records).write(visit);
}

void write_tilesets(FileSystem& files, const std::filesystem::path& directory, const Tree& tree,
                    std::span<const TileRecord> records, Manifest& manifest) {
  Checksum sum;
  std::filesystem::path made;
  for_each_tileset(manifest, tree, records, [&](const TilesetFile& file) {
    const std::filesystem::path path = directory / file.path;
    const auto bytes = std::as_bytes(std::span(file.text));
    if (path.parent_path() != made)
      files.make_directories(made = path.parent_path());
    write_file(files, path, bytes);
    sum.add(bytes);
    ++manifest.tileset_files;
    manifest.tileset_bytes += bytes.size();
  });
  manifest.tileset_checksum = sum.value();
  manifest.total_bytes += manifest.tileset_bytes;
}

Transform globe_transform(double longitude, double latitude, double height, Vec3d anchor,
                          UpAxis up) {
  const UnitTurn lambda = turn_by(longitude * std::numbers::pi / 180);
  const UnitTurn phi = turn_by(latitude * std::numbers::pi / 180);
  const Vec3d east{-lambda.sine, lambda.cosine, 0};
  const Vec3d north{-phi.sine * lambda.cosine, -phi.sine * lambda.sine, phi.cosine};
  const Vec3d away = wgs84::up_at(lambda, phi);
  const Vec3d place = wgs84::geocentric(lambda, phi, height);
  const Vec3d a = to_z_up(anchor, up);
  const Vec3d shift = place - (east * a.x + north * a.y + away * a.z);
  return {east.x, east.y, east.z, 0, north.x, north.y, north.z, 0,
          away.x, away.y, away.z, 0, shift.x, shift.y, shift.z, 1};
}

}  // namespace meshhier::storage
