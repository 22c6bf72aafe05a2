#include "geodesy/map_change.h"

#include "geodesy/proj_objects.h"

#include <utility>

#include <fmt/format.h>

namespace meshhier::geodesy {

using proj::library;

struct MapChange::Parts {
  proj::Context context;
  proj::Object operation;
  std::string from, to;
};

MapChange::MapChange(const std::string& from, const std::string& to)
    : parts_(std::make_unique<Parts>()) {
  Parts& parts = *parts_;
  parts.context = proj::make_context();
  PJ_CONTEXT* context = parts.context.get();
  const auto part_of = [&](const std::string& text) {
    return proj::horizontal_part(context, proj::make_crs(context, text).get());
  };
  const proj::Object source = part_of(from), target = part_of(to);
  const proj::Object operation(
      library().create_crs_to_crs_from_pj(context, source.get(), target.get(), nullptr, nullptr));
  if (operation)
    parts.operation.reset(library().normalize_for_visualization(context, operation.get()));
  if (!parts.operation) {
    proj::refuse("PROJ knows no way from " + proj::in_quotes(from) + " to " + proj::in_quotes(to));
  }
  parts.from = proj::in_quotes(from);
  parts.to = proj::in_quotes(to);
}

MapChange::~MapChange() = default;
MapChange::MapChange(MapChange&&) noexcept = default;
MapChange& MapChange::operator=(MapChange&&) noexcept = default;

void MapChange::settle_at(Vec3d place) {
  if (!find(place))
    return;
  proj::Object used(library().trans_get_last_used_operation(parts_->operation.get()));
  if (used)
    parts_->operation = std::move(used);
}

std::optional<Vec3d> MapChange::find(Vec3d place) const {
  PJ* operation = parts_->operation.get();
  library().errno_reset(operation);
  const PJ_COORD to =
      library().trans(operation, PJ_FWD, library().coord(place.x, place.y, place.z, 0));
  const Vec3d found{to.xyz.x, to.xyz.y, to.xyz.z};
  return is_finite(found) ? std::optional(found) : std::nullopt;
}

Vec3d MapChange::operator()(Vec3d place) const {
  const auto found = find(place);
  if (!found) {
    proj::refuse(fmt::format("{} {} of {} is no place of {}, as far as PROJ can tell", place.x,
                             place.y, parts_->from, parts_->to));
  }
  return *found;
}

bool MapChange::takes_datums_as_one() const {
  return library().coordoperation_has_ballpark_transformation(parts_->context.get(),
                                                              parts_->operation.get()) != 0;
}

}  // namespace meshhier::geodesy
