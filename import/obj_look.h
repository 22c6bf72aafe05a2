// The look of an OBJ file's triangles: pictures, or colours of its materials.
#pragma once

#include "execution/spool_cursor.h"
#include "import/added_file.h"
#include "import/material_colours.h"
#include "import/obj_parts.h"
#include "import/obj_textures.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace meshhier::importing {

/// The pictures that triangles of a textured file show.
struct ObjSurface {
  ObjSurface(std::vector<LibraryMaterial> materials, mesh_io::NamedFiles& files, RawMesh& mesh,
             const ImportRoom& room)
      : textures(std::move(materials), files, mesh.materials),
        tiles(room.scratch, kImportSpoolBytes) {}

  ObjTextures textures;
  storage::RecordSpool<std::uint32_t> tiles;  ///< one a triangle if a material has them
};

/// Triangles of a textured file with what they show, from the first on.
class ShownTriangles {
 public:
  ShownTriangles(const ObjParts& parts, ObjSurface& surface, const ImportRoom& room)
      : surface_(surface),
        triangles_(parts.triangles, room.cancel),
        names_(parts.materials, room.cancel),
        tiles_(surface.tiles, room.cancel) {}

  std::uint64_t count() const { return triangles_.size(); }
  const mesh_io::ObjTriangle& triangle(std::uint64_t i) { return triangles_.at(i); }
  ObjTextures::Shown shown(std::uint64_t i) {
    const std::uint32_t name = names_.at(i);
    std::optional<PictureTile> tile;  // none: there was no picture when it was looked for
    if (has_texcoords(triangles_.at(i))) {
      if (!surface_.textures.is_tiled(name))
        tile = PictureTile();
      else if (const std::uint32_t number = tiles_.at(i); number > 0)
        tile = PictureTile::from(number);
    }
    return surface_.textures.show(name, tile);
  }

 private:
  ObjSurface& surface_;
  execution::SpoolCursor<mesh_io::ObjTriangle> triangles_;
  execution::SpoolCursor<std::uint32_t> names_, tiles_;
};

/// The colours that materials have in a file without pictures.
class ObjPaint {
 public:
  explicit ObjPaint(const std::vector<LibraryMaterial>& materials) {
    for (const LibraryMaterial& material : materials) {
      const PlainColour colour = PlainColour::of(material.material);
      parts_.push_back(material.is_defined ? colour.number() + 1 : 0);
      all_.add(colour);
    }
  }

  bool is_seen() const { return all_.are_seen(); }
  std::size_t count() const { return all_.count(); }

  /// Returns CornerParts::kMaterial of a triangle of that name; 0 if nobody says its colour.
  std::uint32_t part(std::uint32_t name) const { return parts_[name]; }
  /// Returns the colour of a vertex with that part.
  static PlainColour colour(std::uint32_t part) {
    return part == 0 ? PlainColour() : PlainColour::from(part - 1);
  }

 private:
  std::vector<std::uint32_t> parts_;  ///< of each name
  PlainColours all_;
};

/// The look of a file's materials: pictures, their colours, or nothing.
struct ObjLook {
  std::unique_ptr<ObjSurface> surface;
  std::optional<ObjPaint> paint;
};

/// Finds what triangles show, in the libraries that the file names: pictures if `added` has texture
/// coordinates, else colours where vertices have none. Counts what is missing in `added`; the
/// table of `mesh` gets the pictures. Throws as read_libraries().
ObjLook find_look(const ObjParts& parts, AddedFile& added, RawMesh& mesh,
                  mesh_io::NamedFiles& files, const ImportRoom& room);

}  // namespace meshhier::importing
