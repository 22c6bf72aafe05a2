#include "mesh_io/ply_body.h"

#include "mesh_io/coordinate_range.h"
#include "mesh_io/input_error.h"
#include "mesh_io/ply_values.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace meshhier::mesh_io {

std::string row_name(const PlyElementPlan& plan, std::uint64_t row) {
  return fmt::format("row {} of {} of element {}", row, plan.element.count,
                     in_quotes(plan.element.name));
}

std::unique_ptr<PlyBody> make_body(const InputFile& input, const PlyPlan& plan, PlyPosition start) {
  return plan.encoding == PlyEncoding::ascii ? make_text_body(input, plan, start)
                                             : make_binary_body(input, plan, start);
}

bool is_strip_restart(std::int64_t index, PlyType type) {
  return index == -1 || (type == PlyType::u32 && index == std::int64_t{0xffffffff});
}

static std::string slot_name(const PlyElementPlan& plan, int slot) {
  const auto found = std::find(plan.slots.begin(), plan.slots.end(), slot);
  return plan.element.properties[static_cast<std::size_t>(found - plan.slots.begin())].name;
}

std::string defect_text(const PlyElementPlan& plan, std::uint64_t row, int slot, double value) {
  const char* expected = !std::isfinite(value)        ? "a finite number"
                         : slot < kFirstAttributeSlot ? kCoordinateRange
                                                      : "an integer from 0 to 255";
  return fmt::format("expected {} as '{}' in {}, found {}", expected, slot_name(plan, slot),
                     row_name(plan, row), value);
}

std::size_t most_items(const PlyElementPlan& plan, std::size_t property) {
  return property == plan.corners ? PlyFace::kMostCorners : 2 * PlyFace::kMostCorners;
}

std::string corners_text(const PlyElementPlan& plan, std::uint64_t row, std::uint64_t count) {
  return fmt::format(
      "expected at most {} corners with texture coordinates in {}, found a list of "
      "{}",
      PlyFace::kMostCorners, row_name(plan, row), count);
}

std::string index_text(const PlyElementPlan& plan, std::uint64_t row, std::int64_t index,
                       std::uint64_t vertex_count) {
  return fmt::format("expected a vertex index below {}, the number of vertices, in {}, found {}",
                     vertex_count, row_name(plan, row), index);
}

std::optional<TriangleRows> triangle_rows(const PlyElementPlan& faces, std::uint64_t vertex_count) {
  const std::vector<PlyProperty>& properties = faces.element.properties;
  const PlyProperty& corners = properties[faces.corners];
  const auto lists = std::count_if(properties.begin(), properties.end(),
                                   [](const PlyProperty& p) { return p.is_list(); });
  const bool usual = faces.role == PlyElementPlan::Role::polygons && lists == 1 &&
                     corners.count_type == PlyType::u8 &&
                     (corners.type == PlyType::i32 || corners.type == PlyType::u32);
  if (!usual)
    return std::nullopt;
  TriangleRows rows;
  for (std::size_t i = 0; i < faces.corners; ++i)
    rows.before += size_of(properties[i].type);
  rows.stride = faces.min_row_bytes + 3 * sizeof(std::uint32_t);
  // A negative int is a uint of 2^31 or more.
  rows.limit =
      corners.type == PlyType::i32 ? std::min(vertex_count, std::uint64_t{1} << 31) : vertex_count;
  return rows;
}

}  // namespace meshhier::mesh_io
