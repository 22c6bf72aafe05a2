#include "import/gltf_copies.h"

#include "mesh_io/gltf_elements.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using mesh_io::GltfElements;
using mesh_io::GltfElementSource;
using mesh_io::GltfFile;

std::optional<GltfElements> placements(GltfFile& file, std::optional<std::uint32_t> accessor,
                                       std::uint32_t components) {
  if (!accessor)
    return std::nullopt;
  GltfElementSource source = gltf_elements_of(file, *accessor);
  if (source.components != components)
    file.fail(fmt::format("{} has {} components, but places copies of a mesh by {}", source.name,
                          source.components, components));
  return GltfElements(file, std::move(source));
}

}  // namespace

std::uint64_t copy_count(const mesh_io::GltfDocument& document,
                         const mesh_io::GltfInstance& instance) {
  if (!instance.copies)
    return 1;
  for (const auto& part :
       {instance.copies->translation, instance.copies->rotation, instance.copies->scale}) {
    if (part)
      return document.accessors[*part].count;
  }
  return 1;
}

void for_each_copy(GltfFile& file, const mesh_io::GltfInstance& instance,
                   const std::function<void(const mesh_io::GltfTransform&)>& visit) {
  if (!instance.copies)
    return visit(instance.transform);
  std::array<std::optional<GltfElements>, 3> parts{
      placements(file, instance.copies->translation, 3),
      placements(file, instance.copies->rotation, 4), placements(file, instance.copies->scale, 3)};
  const std::uint64_t count = copy_count(file.document(), instance);
  for (const auto& part : parts) {
    if (part && part->size() != count)
      file.fail(fmt::format("{} places {} copies of a mesh, others place {}", part->source().name,
                            part->size(), count));
  }
  const auto numbers = [&](std::size_t part, std::uint64_t i, std::array<double, 4> otherwise) {
    if (parts[part])
      std::ranges::copy(parts[part]->at(i), otherwise.begin());
    return otherwise;
  };
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto t = numbers(0, i, {0, 0, 0, 0});
    const auto turn = numbers(1, i, {0, 0, 0, 1});
    const auto s = numbers(2, i, {1, 1, 1, 0});
    if (turn == std::array<double, 4>{})
      file.fail(fmt::format("{}: element {} is a rotation of zeros", parts[1]->source().name, i));
    visit(instance.transform *
          mesh_io::gltf_placement({t[0], t[1], t[2]}, turn, {s[0], s[1], s[2]}));
  }
}

}  // namespace meshhier::importing
