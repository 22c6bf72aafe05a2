#include "import/material_table.h"

#include "hierarchy/error.h"
#include "hierarchy/plain_text.h"

#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

constexpr std::size_t kLongestName = 255;

}  // namespace

std::uint32_t MaterialTable::add_picture(images::ImageSource picture) {
  const auto number = static_cast<std::uint32_t>(list_.images.size());
  if (!picture.file.empty()) {
    const Place place{picture.file.string(), picture.offset, picture.bytes};
    const auto [known, is_new] = known_.emplace(place, number);
    if (!is_new)
      return known->second;
  }
  list_.images.push_back(std::move(picture));
  return number;
}

std::uint32_t MaterialTable::add(images::Material material) {
  if (list_.materials.size() == kMost)
    throw Error(ErrorCode::input, fmt::format("the input has more than {} materials", kMost));
  list_.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(list_.materials.size() - 1);
}

void MaterialTable::miss(const std::string& name, const std::string& place,
                         const std::vector<std::filesystem::path>& sought) {
  if (missing_.empty())
    first_missing_ = plain_text(name, kLongestName) + " of " + plain_text(place, kLongestName);
  missing_.emplace(name, place);
  companions_.await(sought);
}

std::string MaterialTable::warning(bool is_textured) const {
  if (missing_.empty())
    return {};
  const bool is_one = missing_.size() == 1;
  return fmt::format("{} of the mesh {} missing ({}{}): {}", counted(missing_.size(), "pictures"),
                     is_one ? "is" : "are", is_one ? "" : "the first is ", first_missing_,
                     is_textured ? "triangles show the colour of their material instead"
                                 : "the mesh is read as one without textures");
}

}  // namespace meshhier::importing
