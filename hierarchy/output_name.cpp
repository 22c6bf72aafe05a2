#include "hierarchy/output_name.h"

#include "hierarchy/error.h"
#include "hierarchy/small_letters.h"

#include <algorithm>
#include <array>
#include <string>

namespace meshhier {
namespace {

/// Meshes and scenes, hierarchies, archives, documents, pictures, clouds of points.
constexpr auto kKnownEndings = std::to_array<std::string_view>(
    {".3ds",  ".3mf",  ".abc", ".b3dm", ".blend", ".ctm",  ".dae",  ".drc", ".dxf",  ".fbx",
     ".glb",  ".gltf", ".obj", ".off",  ".ply",   ".step", ".stl",  ".stp", ".usd",  ".usda",
     ".usdc", ".usdz", ".vtk", ".wrl",  ".x3d",   ".3tz",  ".hier", ".7z",  ".bz2",  ".gz",
     ".rar",  ".tar",  ".tgz", ".xz",   ".zip",   ".zst",  ".csv",  ".htm", ".html", ".json",
     ".pdf",  ".xml",  ".bmp", ".gif",  ".jpeg",  ".jpg",  ".ktx2", ".png", ".tif",  ".tiff",
     ".webp", ".e57",  ".las", ".laz",  ".pcd"});

}  // namespace

void require_true_ending(std::string_view name, std::initializer_list<std::string_view> own,
                         std::string_view advice) {
  const std::size_t dot = name.find_last_of("./");
  if (dot == std::string_view::npos || name[dot] != '.')
    return;
  const std::string ending = small_letters(std::string(name.substr(dot)));
  if (std::ranges::find(own, ending) != own.end() ||
      std::ranges::find(kKnownEndings, ending) == kKnownEndings.end())
    return;
  throw Error(ErrorCode::usage, std::string(name) + ": " + std::string(advice));
}

}  // namespace meshhier
