#include "import/obj_look.h"

#include "base/small_letters.h"
#include "import/gather_values.h"
#include "mesh_io/input_error.h"

#include <array>
#include <set>
#include <string>

namespace meshhier::importing {
namespace {

/// Gathers the coordinates of all corners, so that they come in the triangles' order.
void gather_texcoords(const ObjParts& parts, storage::RecordSpool<ObjParts::Texcoord>& gathered,
                      const ImportRoom& room) {
  if (3 * parts.triangles.size() >= UINT32_MAX) {
    mesh_io::fail_file(parts.names.obj(),
                       "has more triangles than textures of several pictures (<UDIM>) allow");
  }
  References corners(room.scratch, kImportSpoolBytes);
  execution::SpoolCursor triangles(parts.triangles, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    for (const mesh_io::ObjCorner& corner : triangles.at(i))
      corners.append(corner.texcoord + 1);
  }
  gather(corners, parts.texcoords, gathered, room);
}

/// Finds the square of each triangle whose material has a picture for each, and the pictures; 0:
/// the whole picture, or no square has one.
void find_tiles(const ObjParts& parts, ObjSurface& surface, const ImportRoom& room) {
  storage::RecordSpool<ObjParts::Texcoord> gathered(room.scratch, kImportSpoolBytes);
  gather_texcoords(parts, gathered, room);
  ObjTextures& textures = surface.textures;
  execution::SpoolCursor triangles(parts.triangles, room.cancel);
  execution::SpoolCursor names(parts.materials, room.cancel);
  execution::SpoolCursor texcoords(gathered, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t name = names.at(i);
    std::optional<PictureTile> tile;
    if (textures.is_tiled(name) && has_texcoords(triangles.at(i))) {
      const ObjParts::Texcoord a = texcoords.at(3 * i), b = texcoords.at(3 * i + 1);
      tile = textures.tile_of(name, {a, b, texcoords.at(3 * i + 2)});
    }
    surface.tiles.append(tile && textures.find_picture(name, *tile) ? tile->number() : 0);
  }
}

/// Returns whether a name means a material, and is not one that programs write where there is none.
bool is_name(const std::string& name) {
  const std::string small = small_letters(name);
  return !small.empty() && small != "none" && small != "(null)" && small != "null";
}

/// Returns the material of each name in `parts`.
std::vector<LibraryMaterial> find_materials(const ObjParts& parts, AddedFile& added, RawMesh& mesh,
                                            mesh_io::NamedFiles& files, const ImportRoom& room) {
  Libraries libraries =
      read_libraries(parts.names, files, mesh.materials.companions(), room.cancel);
  const std::vector<MaterialNames::Use>& uses = parts.names.all();
  std::set<std::string> undefined;
  std::uint64_t other_alphas = 0;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const LibraryMaterial& material = libraries.materials[i];
    const bool is_undefined =
        uses[i].name && !material.is_defined && undefined.insert(*uses[i].name).second;
    if (is_undefined && libraries.missing == 0 && is_name(*uses[i].name))
      mesh.materials.miss_material(*uses[i].name, parts.names.obj());
    other_alphas += material.has_other_alpha ? 1 : 0;
  }
  if (libraries.defined > 1 && !parts.names.are_used())
    mesh.materials.leave_materials(parts.names.obj());
  if (libraries.missing > 0 && !undefined.empty())
    mesh.materials.miss_library(libraries.first_missing, parts.names.obj());
  added.count("missing_material_libraries", libraries.missing);
  added.count("libraries_with_colours_of_bytes", libraries.of_bytes);
  added.count("undefined_materials", undefined.size());
  added.count("ignored_alpha_images", other_alphas);
  if (libraries.of_bytes > 0) {
    added.warnings.push_back(mesh_io::file_message(
        parts.names.obj(),
        "the colours (Kd) of its materials are whole numbers up to 255: they are taken for "
        "bytes"));
  }
  return std::move(libraries.materials);
}

/// Looks for the pictures that triangles show; none if there are none.
std::unique_ptr<ObjSurface> find_surface(const ObjParts& parts,
                                         std::vector<LibraryMaterial> materials, RawMesh& mesh,
                                         mesh_io::NamedFiles& files, const ImportRoom& room) {
  const std::vector<MaterialNames::Use>& uses = parts.names.all();
  auto surface = std::make_unique<ObjSurface>(std::move(materials), files, mesh, room);
  ObjTextures& textures = surface->textures;
  bool is_tiled = false;
  for (std::uint32_t name = 0; name < uses.size(); ++name) {
    if (!uses[name].has_texcoords)
      continue;
    if (textures.is_tiled(name))
      is_tiled = true;
    else
      textures.find_picture(name, {});
  }
  if (is_tiled)
    find_tiles(parts, *surface, room);
  return textures.has_pictures() ? std::move(surface) : nullptr;
}

}  // namespace

ObjLook find_look(const ObjParts& parts, AddedFile& added, RawMesh& mesh,
                  mesh_io::NamedFiles& files, const ImportRoom& room) {
  const bool all_have_colours = parts.counts.coloured == parts.counts.positions;
  ObjLook look;
  if (!added.layout.texcoords && (all_have_colours || !parts.names.are_any()))
    return look;
  std::vector<LibraryMaterial> materials = find_materials(parts, added, mesh, files, room);
  ObjPaint paint(materials);
  if (added.layout.texcoords)
    look.surface = find_surface(parts, std::move(materials), mesh, files, room);
  // Beside colours of vertices, one shade of grey is one as well.
  if (!look.surface && !all_have_colours && (parts.counts.coloured > 0 || paint.is_seen()))
    look.paint = std::move(paint);
  return look;
}

}  // namespace meshhier::importing
