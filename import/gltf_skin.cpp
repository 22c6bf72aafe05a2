#include "import/gltf_skin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using mesh_io::GltfElements;
using mesh_io::GltfElementSource;
using mesh_io::GltfTransform;

std::string set_name(const char* attribute, std::size_t set) {
  return fmt::format("{}_{}", attribute, set);
}

bool has_set(const mesh_io::GltfPrimitive& primitive, std::size_t set) {
  return primitive.attribute(set_name("JOINTS", set)) &&
         primitive.attribute(set_name("WEIGHTS", set));
}

void add_weighted(GltfTransform& sum, const GltfTransform& t, double weight) {
  for (std::size_t i = 0; i < sum.rows.size(); ++i)
    sum.rows[i] = sum.rows[i] + t.rows[i] * weight;
  sum.offset = sum.offset + t.offset * weight;
}

}  // namespace

std::vector<GltfTransform> joint_matrices(mesh_io::GltfFile& file, const mesh_io::GltfSkin& skin,
                                          const mesh_io::GltfScene& scene) {
  std::vector<GltfTransform> matrices;
  std::optional<GltfElements> inverse;
  if (skin.inverse_binds) {
    GltfElementSource source = gltf_elements_of(file, *skin.inverse_binds);
    if (source.components != 16 || source.count < skin.joints.size()) {
      file.fail(fmt::format("{} has {} elements of {} numbers for the matrices of {} joints",
                            source.name, source.count, source.components, skin.joints.size()));
    }
    inverse.emplace(file, std::move(source));
  }
  for (std::size_t i = 0; i < skin.joints.size(); ++i) {
    GltfTransform bind;
    if (inverse) {
      std::array<double, 16> columns{};
      std::ranges::copy(inverse->at(i), columns.begin());
      if (!std::ranges::all_of(columns, [](double number) { return std::isfinite(number); }))
        file.fail(fmt::format("{}: element {} is a matrix that is not finite",
                              inverse->source().name, i));
      bind = mesh_io::gltf_matrix(columns);
    }
    matrices.push_back(scene.places[skin.joints[i]] * bind);
  }
  return matrices;
}

bool are_mirrored(const std::vector<GltfTransform>& matrices) {
  const auto count = std::ranges::count_if(matrices, mesh_io::is_mirrored);
  return 2 * static_cast<std::size_t>(count) > matrices.size();
}

bool is_skinned(const mesh_io::GltfPrimitive& primitive) {
  return has_set(primitive, 0);
}

GltfSkinning::GltfSkinning(mesh_io::GltfFile& file, const mesh_io::GltfPrimitive& primitive,
                           const PrimitiveSources& sources,
                           const std::vector<GltfTransform>& matrices, std::uint64_t count)
    : file_(file), matrices_(matrices) {
  for (std::size_t set = 0; has_set(primitive, set); ++set)
    sets_.push_back({elements(sources, set_name("JOINTS", set), count),
                     elements(sources, set_name("WEIGHTS", set), count)});
}

GltfElements GltfSkinning::elements(const PrimitiveSources& sources, const std::string& name,
                                    std::uint64_t count) {
  GltfElementSource source = sources.attribute(name, 4, 4).value();
  if (source.count != count) {
    file_.fail(fmt::format("{} has {} elements for {}, POSITION has {}", source.name, source.count,
                           name, count));
  }
  source.normalized = false;  // weights count by their share
  return {file_, std::move(source)};
}

const GltfTransform& GltfSkinning::matrix(const GltfElements& joints, std::uint32_t vertex,
                                          double joint) const {
  if (!(joint >= 0 && joint < static_cast<double>(matrices_.size()))) {
    file_.fail(fmt::format("{}: element {} has the joint {}, but the skin has {}",
                           joints.source().name, vertex, joint, matrices_.size()));
  }
  return matrices_[static_cast<std::size_t>(joint)];
}

GltfTransform GltfSkinning::at(std::uint32_t vertex) {
  GltfTransform sum{.rows = {}, .offset = {}};
  double total = 0;
  for (Set& set : sets_) {
    const std::span<const double> joints = set.joints.at(vertex);
    const std::span<const double> weights = set.weights.at(vertex);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (!(weights[i] > 0) || !std::isfinite(weights[i]))
        continue;
      add_weighted(sum, matrix(set.joints, vertex, joints[i]), weights[i]);
      total += weights[i];
    }
  }
  if (total == 0)
    return matrix(sets_[0].joints, vertex, sets_[0].joints.at(vertex)[0]);
  if (total == 1)
    return sum;
  GltfTransform mean{.rows = {}, .offset = {}};
  add_weighted(mean, sum, 1 / total);
  return mean;
}

}  // namespace meshhier::importing
