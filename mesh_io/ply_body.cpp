#include "mesh_io/ply_body.h"

#include "mesh_io/input_error.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace meshhier::mesh_io {

std::string row_name(const PlyElementPlan& plan, std::uint64_t row) {
  return fmt::format("row {} of {} of element {}", row, plan.element.count,
                     in_quotes(plan.element.name));
}

bool is_strip_restart(std::int64_t index, PlyType type) {
  return index == -1 || (type == PlyType::u32 && index == std::int64_t{0xffffffff});
}

static std::string slot_name(const PlyElementPlan& plan, int slot) {
  const auto found = std::find(plan.slots.begin(), plan.slots.end(), slot);
  return plan.element.properties[static_cast<std::size_t>(found - plan.slots.begin())].name;
}

std::string defect_text(const PlyElementPlan& plan, std::uint64_t row, int slot, double value) {
  const bool finite = std::isfinite(value);
  return fmt::format("expected {} as '{}' in {}, found {}",
                     finite ? "an integer from 0 to 255" : "a finite number", slot_name(plan, slot),
                     row_name(plan, row), value);
}

std::string index_text(const PlyElementPlan& plan, std::uint64_t row, std::int64_t index,
                       std::uint64_t vertex_count) {
  return fmt::format("expected a vertex index below {}, the number of vertices, in {}, found {}",
                     vertex_count, row_name(plan, row), index);
}

}  // namespace meshhier::mesh_io
