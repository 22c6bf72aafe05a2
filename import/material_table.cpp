#include "import/material_table.h"

#include "base/error.h"
#include "base/plain_text.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

constexpr std::size_t kLongestName = 255;

std::string named(const std::string& name, const std::string& place) {
  return plain_text(name, kLongestName) + " of " + plain_text(place, kLongestName);
}

/// Returns an empty text if none is missing.
std::string missing_text(std::uint64_t count, std::string_view what, const std::string& first,
                         std::string_view consequence) {
  if (count == 0)
    return {};
  return fmt::format("{} of the mesh {} missing ({}{}): {}", counted(count, what),
                     count == 1 ? "is" : "are", count == 1 ? "" : "the first is ", first,
                     consequence);
}

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

std::uint32_t MaterialTable::append(MaterialTable&& other) {
  std::vector<std::uint32_t> numbers;
  for (images::ImageSource& picture : other.list_.images)
    numbers.push_back(add_picture(std::move(picture)));
  const auto first = static_cast<std::uint32_t>(list_.materials.size());
  for (images::Material& material : other.list_.materials) {
    if (material.image)
      material.image = numbers[*material.image];
    add(std::move(material));
  }
  if (missing_.empty())
    first_missing_ = std::move(other.first_missing_);
  missing_.merge(std::move(other.missing_));
  companions_.await(other.companions_.awaited());
  return first;
}

std::uint64_t MaterialTable::mask_mixed() {
  const auto blends = [](const images::Material& m) { return m.alpha == AlphaMode::blend; };
  if (std::ranges::all_of(list_.materials, blends))
    return 0;
  std::uint64_t count = 0;
  for (images::Material& material : list_.materials) {
    if (!blends(material))
      continue;
    const float most = material.image ? material.factor[3] : material.colour[3];
    material.alpha = AlphaMode::mask;
    material.alpha_cutoff = most > 0 ? most / 2 : images::Material().alpha_cutoff;
    ++count;
  }
  return count;
}

void MaterialTable::miss(const std::string& name, const std::string& place,
                         const std::vector<std::filesystem::path>& sought) {
  if (missing_.empty())
    first_missing_ = named(name, place);
  missing_.emplace(name, place);
  companions_.await(sought);
}

void MaterialTable::miss_library(const std::string& name, const std::filesystem::path& obj) {
  if (++missing_libraries_ == 1)
    first_missing_library_ = named(name, obj.string());
}

void MaterialTable::miss_material(const std::string& name, const std::filesystem::path& obj) {
  if (++missing_materials_ == 1)
    first_missing_material_ = named(name, obj.string());
}

std::string MaterialTable::warning_of_materials() const {
  if (missing_materials_ == 0)
    return {};
  return fmt::format(
      "no material library defines {} of the mesh ({}{}): their triangles are shown without "
      "colours "
      "and pictures; name the library by mtllib, or put it beside the mesh under the mesh's name",
      counted(missing_materials_, "materials"), missing_materials_ == 1 ? "" : "the first is ",
      first_missing_material_);
}

std::string MaterialTable::warning_of_left_materials() const {
  if (left_.empty())
    return {};
  return fmt::format(
      "{} names libraries with several materials, but none of its faces has one (usemtl): their "
      "colours and pictures are not shown",
      plain_text(left_[0], kLongestName));
}

std::string MaterialTable::warning(bool is_textured) const {
  return missing_text(missing_.size(), "pictures", first_missing_,
                      is_textured ? "triangles show the colour of their material instead"
                                  : "the mesh is read as one without textures");
}

std::string MaterialTable::warning_of_libraries() const {
  return missing_text(missing_libraries_, "material libraries", first_missing_library_,
                      "the colours and pictures of its materials are not shown");
}

}  // namespace meshhier::importing
