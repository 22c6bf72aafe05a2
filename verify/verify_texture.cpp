// Checks the parts that only tiles with a picture or a normal map have: splits by texture
// coordinates, and the pictures.
#include "base/error.h"
#include "images/formats.h"
#include "images/image_codec.h"
#include "storage/format/layout.h"
#include "verify/verify_parts.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

/// The values that distinguish the vertices and splits at one vertex.
using Look = std::pair<NormalCode, Vec2f>;

Look look_of(const Shading& shading, std::size_t number) {
  return {shading.normals.empty() ? NormalCode{} : shading.normals[number],
          shading.texcoords[number]};
}

/// Returns whether each split is a corner of a triangle.
bool uses_splits(const PublishedTile& tile) {
  const Shading& shading = tile.shading;
  std::vector<bool> used(shading.texcoords.size());
  for (const auto* triangles : {&shading.interior, &shading.border}) {
    for (const TileTriangle& t : *triangles) {
      for (const TileVertex v : t)
        used[raw(v)] = true;
    }
  }
  const std::size_t first = shading.texcoords.size() - shading.split_of.size();
  return std::find(used.begin() + static_cast<std::ptrdiff_t>(first), used.end(), false) ==
         used.end();
}

/// Returns whether each split differs from its vertex and from the other splits of that. O(splits
/// log splits).
bool has_different_splits(const Shading& shading) {
  const std::size_t first = shading.texcoords.size() - shading.split_of.size();
  const auto bits = [](const Look& look) {
    std::array<std::uint32_t, 3> words{};
    std::memcpy(words.data(), look.first.data(), sizeof(NormalCode));
    std::memcpy(&words[1], &look.second, sizeof(Vec2f));
    return words;
  };
  std::vector<std::pair<std::uint32_t, std::array<std::uint32_t, 3>>> looks;
  for (std::size_t i = 0; i < shading.split_of.size(); ++i) {
    const std::uint32_t vertex = shading.split_of[i];
    if (i == 0 || vertex != shading.split_of[i - 1])
      looks.emplace_back(vertex, bits(look_of(shading, vertex)));
    looks.emplace_back(vertex, bits(look_of(shading, first + i)));
  }
  std::sort(looks.begin(), looks.end());
  return std::adjacent_find(looks.begin(), looks.end()) == looks.end();
}

/// Decodes all of it, a few rows at a time; nothing where this machine cannot.
/// `is_coded_here`: no process of another program is needed.
void read_picture(const TileImage& image, bool is_coded_here, const std::string& name) {
  const std::span<const std::byte> bytes = image.bytes;
  const auto read = [bytes](std::uint64_t offset, std::span<std::byte> into) {
    const auto rest = bytes.subspan(std::min<std::uint64_t>(offset, bytes.size()));
    const std::size_t count = std::min(rest.size(), into.size());
    std::copy_n(rest.begin(), count, into.begin());
    return count;
  };
  const auto reader = images::open_image(read, name);
  const images::ImageInfo& info = reader->info();
  if (info.format != image.format || info.width != image.width || info.height != image.height) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{} is a {} of {} x {} texels, expected a {} of {} x {}", name,
                            row_of(info.format).name, info.width, info.height,
                            row_of(image.format).name, image.width, image.height));
  }
  if (image.alpha == AlphaMode::opaque && info.channels != 3)
    throw Error(ErrorCode::corrupt, name + " has alpha, but the material is opaque");
  if (!reader->missing().empty()) {
    if (is_coded_here)
      throw Error(ErrorCode::corrupt, name + " is ETC1S, expected UASTC");
    return;
  }
  constexpr std::uint32_t kRows = 16;
  std::vector<std::uint8_t> rows(std::size_t{kRows} * info.width * info.channels);
  for (std::uint32_t y = 0; y < info.height; y += kRows)
    reader->read_rows(rows.data(), std::min(kRows, info.height - y));
}

}  // namespace

void verify_texture(const VerifyJob& job, const PublishedTile& tile) {
  const std::string path = storage::tile_path(job.reader.directory(), tile.node).string();
  if (!uses_splits(tile))
    job.problems.add(path + ": a split is the corner of no triangle");
  if (!has_different_splits(tile.shading))
    job.problems.add(path + ": a split is like its vertex, or like another split of that");
  try {
    const auto& textures = job.reader.manifest().textures;
    const bool is_coded_here = !textures || images::missing_coder(*textures).empty();
    if (!tile.image.empty())
      read_picture(tile.image, is_coded_here, path + ": the picture");
    if (!tile.normal_map.empty())
      read_picture(tile.normal_map, true, path + ": the normal map");
  } catch (const Error& error) {
    job.problems.add(error.what());
  }
}

}  // namespace meshhier::verifying
