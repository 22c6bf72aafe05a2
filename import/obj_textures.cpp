#include "import/obj_textures.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier::importing {

std::optional<PictureTile> PictureTile::at(double column, double row) {
  constexpr double kColumns = 10;
  constexpr double kRows = 899;  // 1001 to 9990
  if (!(column >= 0 && column < kColumns && row >= 0 && row < kRows))
    return std::nullopt;
  return PictureTile(kFirst + static_cast<std::uint32_t>(column) +
                     10 * static_cast<std::uint32_t>(row));
}

std::optional<PictureTile> ObjTextures::tile_of(std::uint32_t name,
                                                const std::array<Texcoord, 3>& corners) const {
  const mesh_io::MtlMap& map = *materials_[name].map;
  // Corners on the border of a square may be rounded to the other side of it: the middle is not.
  std::array<double, 2> middle{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    for (const Texcoord& corner : corners)
      middle[axis] += (corner[axis] * map.scale[axis] + map.offset[axis]) / 3;
  }
  return PictureTile::at(std::floor(middle[0]), std::floor(middle[1]));
}

bool ObjTextures::find_picture(std::uint32_t name, PictureTile tile) {
  const LibraryMaterial& material = materials_[name];
  if (!material.map)
    return false;
  const auto [known, is_new] = pictures_.try_emplace({name, tile});
  std::optional<std::filesystem::path>& picture = known->second;
  if (is_new) {
    const std::string file = material.file_of(tile.number());
    const std::filesystem::path folder = material.defined_in.parent_path();
    picture = files_.find(folder, file);
    if (!picture)
      table_.miss(file, material.defined_in.string(), mesh_io::sought_places(folder, file));
  }
  has_pictures_ |= picture.has_value();
  return picture.has_value();
}

ObjTextures::Shown ObjTextures::show(std::uint32_t name, std::optional<PictureTile> tile) {
  if (!tile || !find_picture(name, *tile))
    tile.reset();
  const auto known = shown_.find({name, tile});
  if (known != shown_.end())
    return known->second;
  const Shown shown = make(name, tile, tile ? pictures_.at({name, *tile}) : std::nullopt);
  shown_.emplace(std::pair(name, tile), shown);
  return shown;
}

ObjTextures::Shown ObjTextures::make(std::uint32_t name, std::optional<PictureTile> tile,
                                     const std::optional<std::filesystem::path>& picture) {
  const LibraryMaterial& known = materials_[name];
  images::Material material = known.material;
  Mapping mapping;
  if (picture) {
    material.factor[3] = material.colour[3];
    material.image = table_.add_picture({known.file_of(tile->number()), *picture});
    mapping = {known.map->scale, known.map->offset};
    mapping.offset[0] -= tile->column();
    mapping.offset[1] -= tile->row();
  } else if (material.alpha == AlphaMode::mask) {
    material.alpha = AlphaMode::opaque;
  }
  mappings_.push_back(mapping);
  return {table_.add(std::move(material)), picture.has_value()};
}

Vec2f ObjTextures::texcoord(std::uint32_t number, Texcoord texcoord) const {
  const Mapping& mapping = mappings_[number - first_number_];
  const auto on_picture = [&](std::size_t axis) {
    return texcoord[axis] * mapping.scale[axis] + mapping.offset[axis];
  };
  constexpr double kMost = std::numeric_limits<float>::max();
  return {static_cast<float>(std::clamp(on_picture(0), -kMost, kMost)),
          static_cast<float>(std::clamp(1 - on_picture(1), -kMost, kMost))};
}

}  // namespace meshhier::importing
