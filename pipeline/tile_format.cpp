#include "pipeline/tile_format.h"

#include "hierarchy/lattice.h"

#include <optional>

namespace meshhier::pipeline {
namespace {

/// Returns the lattice over the input's bounds as they are stored; nothing if positions stay exact.
std::optional<Lattice> lattice_of(const DistributedSource& source, const StageContext& context) {
  const std::optional<std::uint32_t>& bits = context.config.storage.position_bits;
  if (!bits)
    return std::nullopt;
  const BoundsD& bounds = source.summary.bounds;
  return make_lattice({to_float(bounds.min - source.origin), to_float(bounds.max - source.origin)},
                      static_cast<int>(*bits));
}

}  // namespace

storage::TileFormat format_of(const DistributedSource& source, bool computed_normals,
                              const TextureStore& textures,
                              const std::vector<ObjectProperty>* objects,
                              const StageContext& context) {
  storage::TileFormat format = {source.summary.attributes,
                                {{}, context.config.up_axis()},  // the origin is in the tileset
                                context.config.storage.compression,
                                {}};
  format.computed_normals = computed_normals;
  if (source.summary.textures)
    format.textures = context.config.picture_format();
  if (context.plan.job.normal_map_side > 0 && textures.has_normal_maps())
    format.normal_maps = context.config.normal_map.format;
  format.lattice = lattice_of(source, context);
  if (objects != nullptr)
    format.objects = *objects;
  return format;
}

}  // namespace meshhier::pipeline
