#include "mesh_io/ply_header.h"

#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "mesh_io/ply_plan.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>

#include <fmt/format.h>

namespace meshhier::tests::fuzz {
namespace {

using mesh_io::PlyElement;
using mesh_io::PlyElementPlan;
using mesh_io::PlyHeader;
using mesh_io::PlyPlan;
using mesh_io::PlyProperty;

constexpr const char* kHeaderName = "mesh.ply";

/// As the paper writes it. A name may hold the line end that its file does not use.
std::string header_text(const PlyHeader& header) {
  constexpr std::string_view kFormats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  std::string text =
      fmt::format("ply\nformat {} 1.0\n", kFormats[static_cast<std::size_t>(header.encoding)]);
  bool feeds = false;
  for (const PlyElement& element : header.elements) {
    text += fmt::format("element {} {}\n", element.name, element.count);
    for (const PlyProperty& property : element.properties) {
      const std::string list =
          property.count_type ? fmt::format("list {} ", name_of(*property.count_type)) : "";
      feeds = feeds || property.name.find('\n') != std::string::npos;
      for (int i = 0; i < std::max<int>(property.fixed_count, 1); ++i)
        text += fmt::format("property {}{} {}\n", list, name_of(property.type), property.name);
    }
  }
  text += "end_header\n";
  return feeds ? std::string() : text;
}

bool is_same(const PlyHeader& a, const PlyHeader& b) {
  const auto same_property = [](const PlyProperty& p, const PlyProperty& q) {
    return p.name == q.name && p.type == q.type && p.count_type == q.count_type &&
           p.fixed_count == q.fixed_count;
  };
  const auto same_element = [&](const PlyElement& e, const PlyElement& f) {
    return e.name == f.name && e.count == f.count &&
           std::equal(e.properties.begin(), e.properties.end(), f.properties.begin(),
                      f.properties.end(), same_property);
  };
  return a.encoding == b.encoding && std::equal(a.elements.begin(), a.elements.end(),
                                                b.elements.begin(), b.elements.end(), same_element);
}

void check_header(const PlyHeader& header, std::size_t size) {
  require(header.data_offset <= size, "the data begins in the file");
  std::set<std::string> names;
  for (const PlyElement& element : header.elements) {
    require(!element.name.empty() && names.insert(element.name).second, "names are unique");
    for (const PlyProperty& property : element.properties) {
      require(!property.name.empty(), "properties have names");
      require(!property.count_type || is_integer(*property.count_type), "lengths are integers");
    }
  }
  const std::string text = header_text(header);
  if (!text.empty()) {
    require(is_same(mesh_io::parse_ply_header(text, kHeaderName), header),
            "a header written plainly is the same header");
  }
}

void check_vertices(const PlyPlan& plan) {
  const PlyElementPlan& vertices = plan.elements.at(plan.vertex_element);
  require(vertices.role == PlyElementPlan::Role::vertices, "the vertices are the vertices");
  std::set<int> slots;
  for (const int slot : vertices.slots)
    require(slot == mesh_io::kSkipped || slots.insert(slot).second, "a slot is filled once");
  int value = mesh_io::kFirstAttributeSlot +
              static_cast<int>(plan.attributes.part(AttributeKind::values).first);
  for (const ScalarAttribute& attribute : plan.attributes.values) {
    if (takes_two_channels(attribute.type))
      require(slots.insert(value + 1).second, "a value has its channels");
    value += channels_of(attribute.type);
  }
  const int last = mesh_io::kFirstAttributeSlot + plan.attributes.channels() - 1;
  require(static_cast<int>(slots.size()) == last + 1 && *slots.rbegin() == last,
          "every slot is filled");
}

void check_plan(const PlyHeader& header, std::uint64_t file_bytes) {
  PlyPlan plan;
  const auto make = [&] { plan = mesh_io::make_ply_plan(header, file_bytes, kHeaderName); };
  if (!refusal({ErrorCode::input}, "mesh.ply: ", make).empty())
    return;
  require(plan.elements.size() == header.elements.size(), "a plan for each element");
  std::uint64_t least = header.data_offset;
  for (const PlyElementPlan& element : plan.elements) {
    require(element.slots.size() == element.element.properties.size(), "a slot a property");
    require(!element.has_faces() || element.element.properties.at(element.corners).is_list(),
            "faces have a list of corners");
    least += element.element.count * element.min_row_bytes;
  }
  const bool text = plan.encoding == mesh_io::PlyEncoding::ascii;
  require(least <= file_bytes + (text ? plan.elements.size() : 0), "what is declared can fit");
  check_vertices(plan);
}

}  // namespace

void ply_header(Bytes input) {
  const std::string_view start = text_of(input).substr(0, mesh_io::kMaxHeaderBytes);
  PlyHeader header;
  const auto parse = [&] { header = mesh_io::parse_ply_header(start, kHeaderName); };
  if (!refusal({ErrorCode::input}, "mesh.ply: ", parse).empty())
    return;
  check_header(header, input.size());
  check_plan(header, input.size());
  check_plan(header, std::uint64_t{1} << 62);  // a size that nothing but overflow exceeds
}

}  // namespace meshhier::tests::fuzz
