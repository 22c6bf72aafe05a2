#include "import/ply_pictures.h"

#include "hierarchy/image_format.h"
#include "import/input_files.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

/// Returns the names that a texture's picture may have.
std::vector<std::string> names_of(std::int32_t texture, const mesh_io::PlyPlan& plan,
                                  const std::filesystem::path& ply) {
  const auto number = static_cast<std::size_t>(texture);
  if (number < plan.texture_files.size())
    return {plan.texture_files[number]};
  std::vector<std::string> names;
  for (const std::string_view ending : unnamed_picture_endings())
    names.push_back(fmt::format("{}_{}{}", without_gz(ply).stem().string(), texture, ending));
  return names;
}

}  // namespace

PlyPictures::PlyPictures(const mesh_io::PlyPlan& plan, const std::filesystem::path& ply,
                         const std::set<std::int32_t>& textures, mesh_io::NamedFiles& files,
                         MaterialTable& materials) {
  const std::filesystem::path folder = ply.parent_path();
  for (const std::int32_t texture : textures) {
    if (texture < 0)
      continue;
    const std::vector<std::string> names = names_of(texture, plan, ply);
    std::vector<std::filesystem::path> sought;
    for (const std::string& name : names) {
      const auto found = files.find(folder, name);
      if (found) {
        pictures_.emplace(texture, Picture{name, *found});
        break;
      }
      const auto places = mesh_io::sought_places(folder, name);
      sought.insert(sought.end(), places.begin(), places.end());
    }
    if (!is_there(texture)) {
      missing_.emplace(texture, names[0]);
      materials.miss(names[0], ply.string(), sought);
    }
  }
}

std::uint32_t PlyPictures::material_of(std::int32_t texture, MaterialTable& materials) {
  const auto known = numbers_.find(texture);
  if (known != numbers_.end())
    return known->second;
  images::Material material;
  if (const auto found = pictures_.find(texture); found != pictures_.end()) {
    material.name = found->second.name;
    material.image = materials.add_picture({material.name, found->second.path});
  } else if (const auto missing = missing_.find(texture); missing != missing_.end()) {
    material.name = missing->second;
  }
  const std::uint32_t number = materials.add(std::move(material));
  numbers_.emplace(texture, number);
  return number;
}

}  // namespace meshhier::importing
