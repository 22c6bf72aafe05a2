#include "mesh_io/tileset.h"

#include "hierarchy/angle.h"
#include "hierarchy/plain_text.h"
#include "hierarchy/wgs84.h"
#include "mesh_io/gltf_json.h"
#include "mesh_io/gltf_uri.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/tile_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::mesh_io {
namespace {

namespace fs = std::filesystem;

/// A tile takes two levels of JSON below its parent.
constexpr int kDeepestJson = 512;
constexpr std::size_t kMostDocuments = 64;  ///< of which each is within the one before
constexpr std::size_t kLongestContent = 255;

using wgs84::kEquator;
using wgs84::kPole;

struct Document {
  fs::path path;
  nlohmann::json json;
};

Document read_document(storage::FileSystem& files, const fs::path& path, std::uint64_t most_bytes) {
  const auto file = files.open(path);
  const auto stream = open_stream({*file, file->size()}, {});
  std::string text;
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  for (std::size_t got = kBlock; got == kBlock && text.size() <= most_bytes;) {
    const std::size_t size = text.size();
    text.resize(size + kBlock);
    got = stream->read(std::as_writable_bytes(std::span(text)).subspan(size));
    text.resize(size + got);
  }
  return {path, parse_gltf_json(std::move(text), path, most_bytes, kDeepestJson)};
}

GltfTransform transform_of(const GltfObject& tile) {
  const auto numbers = tile.numbers("transform", 16);
  if (!numbers)
    return {};
  std::array<double, 16> columns{};
  std::ranges::copy(*numbers, columns.begin());
  if (!std::ranges::all_of(columns, [](double x) { return std::isfinite(x); }))
    tile.fail("has a transform that is not finite");
  return gltf_matrix(columns);
}

bool is_on_globe(Vec3d p) {
  constexpr double kBelow = 15'000, kAbove = 50'000;
  const double distance = length(p);
  return distance >= kPole - kBelow && distance <= kEquator + kAbove;
}

/// Away from the ellipsoid.
Vec3d up_at(Vec3d p) {
  const Vec3d normal{p.x / (kEquator * kEquator), p.y / (kEquator * kEquator),
                     p.z / (kPole * kPole)};
  return normal * (1 / length(normal));
}

bool is_rigid(const GltfTransform& t) {
  constexpr double kRounded = 1e-6;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = i; k < 3; ++k) {
      if (std::abs(dot(t.rows[i], t.rows[k]) - (i == k ? 1 : 0)) > kRounded)
        return false;
    }
  }
  return !is_mirrored(t);
}

/// Whether the z axis points up there, within some degrees.
bool is_local_frame(const GltfTransform& t) {
  constexpr double kNearlyUp = 0.99;
  const Vec3d z{t.rows[0].z, t.rows[1].z, t.rows[2].z};
  return is_rigid(t) && is_on_globe(t.offset) && dot(z, up_at(t.offset)) > kNearlyUp;
}

GlobeFrame frame_at(Vec3d place) {
  const Vec3d origin{std::round(place.x), std::round(place.y), std::round(place.z)};
  const Vec3d up = up_at(origin);
  const double from_axis = std::sqrt(origin.x * origin.x + origin.y * origin.y);
  const Vec3d east =
      from_axis > 1 ? Vec3d{-origin.y / from_axis, origin.x / from_axis, 0} : Vec3d{0, 1, 0};
  const Vec3d north = cross(up, east);
  return {
      {{Vec3d{east.x, north.x, up.x}, Vec3d{east.y, north.y, up.y}, Vec3d{east.z, north.z, up.z}},
       origin}};
}

/// The middle of a region: west, south, east, north in radians, least and largest height.
Vec3d middle_of_region(const GltfObject& volume, const std::vector<double>& region) {
  constexpr double kTurn = 2 * std::numbers::pi;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!(std::abs(region[i]) <= std::numbers::pi))
      volume.fail("has a region beyond half a turn");
  }
  const double east = region[2] + (region[2] < region[0] ? kTurn : 0);
  const UnitTurn longitude = turn_by((region[0] + east) / 2);
  const UnitTurn latitude = turn_by((region[1] + region[3]) / 2);
  return wgs84::geocentric(longitude, latitude, (region[4] + region[5]) / 2);
}

/// In geocentric coordinates, if the tileset is on the globe.
std::optional<Vec3d> middle_of(const GltfObject& root) {
  const auto volume = root.object("boundingVolume");
  if (!volume)
    return std::nullopt;
  if (const auto region = volume->numbers("region", 6))
    return middle_of_region(*volume, *region);
  auto numbers = volume->numbers("box", 12);
  if (!numbers)
    numbers = volume->numbers("sphere", 4);
  if (!numbers)
    return std::nullopt;
  return transformed(transform_of(root), {(*numbers)[0], (*numbers)[1], (*numbers)[2]});
}

/// From geocentric coordinates to the frame's.
GltfTransform inverse_of(const GlobeFrame& frame) {
  const auto& rows = frame.to_globe.rows;
  GltfTransform turn;
  for (int i = 0; i < 3; ++i)
    turn.rows[static_cast<std::size_t>(i)] = {rows[0][i], rows[1][i], rows[2][i]};
  turn.offset = transformed(turn, frame.to_globe.offset) * -1.0;
  return turn;
}

/// From a glTF's axes to those of 3D Tiles.
GltfTransform axes_of(const GltfObject& asset) {
  const std::string up = asset.text("gltfUpAxis").value_or("Y");
  if (up == "Z" || up == "z")
    return {};
  if (up == "X" || up == "x")
    return {{Vec3d{0, 0, -1}, Vec3d{0, 1, 0}, Vec3d{1, 0, 0}}, {}};
  return {{Vec3d{1, 0, 0}, Vec3d{0, 0, -1}, Vec3d{0, 1, 0}}, {}};
}

bool adds(const GltfObject& tile, bool otherwise) {
  std::string refine = tile.text("refine").value_or("");
  std::ranges::transform(refine, refine.begin(), [](unsigned char c) { return std::toupper(c); });
  return refine.empty() ? otherwise : refine == "ADD";
}

std::optional<GlobeFrame> frame_of(const GltfObject& root) {
  const GltfTransform transform = transform_of(root);
  if (is_local_frame(transform))
    return GlobeFrame{transform};
  const auto middle = middle_of(root);
  return middle && is_on_globe(*middle) ? std::optional(frame_at(*middle)) : std::nullopt;
}

/// From the root's coordinates to the frame's.
GltfTransform placement_in(const std::optional<GlobeFrame>& frame, const GltfTransform& root) {
  if (!frame)
    return root;
  if (root == frame->to_globe)
    return {};  // exactly, without a way to the globe and back
  return inverse_of(*frame) * root;
}

class TilesetReader {
 public:
  TilesetReader(storage::FileSystem& files, const fs::path& path, std::uint64_t most_bytes)
      : files_(files), place_(path.parent_path().lexically_normal()), most_bytes_(most_bytes) {}

  Tileset read(const fs::path& path, const std::optional<GlobeFrame>* frame) {
    const Document document = read_document(files_, path, most_bytes_);
    const GltfObject tileset(document.json, document.path);
    const GltfObject root = tileset.require_object("root");
    found_.frame = frame != nullptr ? *frame : frame_of(root);
    const auto more = tileset.require_object("asset").object("extras");
    found_.is_hierarchy = more && more->has_text("generator", "meshhier");
    read_tiles(document, placement_in(found_.frame, transform_of(root)));
    return std::move(found_);
  }

 private:
  /// `placement`: of the root, its own transform among it.
  void read_tiles(const Document& document, const GltfTransform& placement) {
    if (std::ranges::find(open_, document.path) != open_.end())
      fail_file(document.path, "is a tileset that holds itself");
    if (open_.size() == kMostDocuments)
      fail_file(document.path,
                fmt::format("tilesets lie in each other deeper than {} levels", kMostDocuments));
    open_.push_back(document.path);
    const GltfObject tileset(document.json, document.path);
    const GltfTransform axes = axes_of(tileset.require_object("asset"));
    read_tile(tileset.require_object("root"), placement, axes, false);
    open_.pop_back();
  }

  void read_tile(const GltfObject& tile, const GltfTransform& placement, const GltfTransform& axes,
                 bool parent_adds) {
    if (tile.has("implicitTiling") || tile.extension("3DTILES_implicit_tiling"))
      tile.fail(
          "has implicit tiles, which are not read; write the tileset with explicit ones, or give "
          "the mesh that it was made of");
    const bool is_added = adds(tile, parent_adds);
    const bool is_coarser = !is_added && tile.item_count("children") > 0;
    for_each_content(tile, [&](const GltfObject& content) {
      if (is_coarser)
        ++found_.coarser;
      else
        read_content(content, placement, axes);
    });
    tile.for_each("children", [&](const GltfObject& child) {
      read_tile(child, placement * transform_of(child), axes, is_added);
    });
  }

  template <class Visit>
  static void for_each_content(const GltfObject& tile, const Visit& visit) {
    if (const auto content = tile.object("content"))
      visit(*content);
    tile.for_each("contents", visit);
    if (const auto several = tile.extension("3DTILES_multiple_contents")) {
      several->for_each("contents", visit);
      several->for_each("content", visit);
    }
  }

  void read_content(const GltfObject& content, const GltfTransform& placement,
                    const GltfTransform& axes) {
    const fs::path path = file_of(content);
    const auto file = files_.open(path);
    const TileFile tile = read_tile_file(*file, most_bytes_);
    found_.instanced += tile.instanced;
    found_.points += tile.points;
    if (tile.is_tileset) {
      if (std::ranges::find(found_.documents, path) == found_.documents.end())
        found_.documents.push_back(path);
      const Document document = read_document(files_, path, most_bytes_);
      const GltfObject root = GltfObject(document.json, document.path).require_object("root");
      return read_tiles(document, placement * transform_of(root));
    }
    for (const TileGltf& gltf : tile.meshes) {
      GltfTransform moved;
      moved.offset = gltf.centre;
      found_.meshes.push_back(
          {path, {gltf.kind, false}, gltf.offset, gltf.bytes, placement * moved * axes});
    }
  }

  fs::path file_of(const GltfObject& content) const {
    auto uri = content.text("uri");
    if (!uri)
      uri = content.text("url");
    if (!uri)
      content.fail("has no \"uri\"");
    const std::string shown = plain_text(*uri, kLongestContent);
    if (uri->find("://") != std::string::npos || uri->starts_with("//"))
      content.fail("is on the web (" + shown + "); fetch the whole tileset first");
    const fs::path folder = open_.back().parent_path();
    for (std::string name : names_of_uri(*uri)) {
      for (int i = 0; i < 2; ++i) {
        const fs::path path = (folder / name).lexically_normal();
        if (is_below_place(path) && files_.kind(path) == storage::FileKind::regular)
          return path;
        name.resize(std::min(name.find_first_of("?#"), name.size()));  // what a server would take
      }
    }
    content.fail(fmt::format("is {}, which is no file below the folder of the tileset", shown));
  }

  bool is_below_place(const fs::path& path) const {
    const fs::path relative = path.lexically_relative(place_.empty() ? fs::path(".") : place_);
    return !relative.empty() && *relative.begin() != "..";
  }

  storage::FileSystem& files_;
  fs::path place_;
  std::uint64_t most_bytes_;
  std::vector<fs::path> open_;  ///< documents that are being read, each within the one before
  Tileset found_;
};

}  // namespace

Transform GlobeFrame::matrix() const {
  const auto& [rows, offset] = to_globe;
  Transform matrix = kIdentity;
  for (int column = 0; column < 3; ++column) {
    for (std::size_t row = 0; row < 3; ++row)
      matrix[4 * static_cast<std::size_t>(column) + row] = rows[row][column];
  }
  for (int row = 0; row < 3; ++row)
    matrix[12 + static_cast<std::size_t>(row)] = offset[row];
  return matrix;
}

std::optional<GlobeFrame> globe_frame(storage::FileSystem& files, const fs::path& path,
                                      std::uint64_t most_bytes) {
  const Document document = read_document(files, path, most_bytes);
  const GltfObject root = GltfObject(document.json, document.path).require_object("root");
  return frame_of(root);
}

Tileset read_tileset(storage::FileSystem& files, const fs::path& path,
                     const std::optional<GlobeFrame>* frame, std::uint64_t most_bytes) {
  return TilesetReader(files, path, most_bytes).read(path, frame);
}

}  // namespace meshhier::mesh_io
