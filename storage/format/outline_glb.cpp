#include "storage/format/outline_glb.h"

#include "base/bounds.h"
#include "base/error.h"
#include "storage/format/glb.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kExtension = "MESHHIER_outline";
constexpr unsigned kOutlineVersion = 1;

// A primitive mode of the glTF 2.0 specification.
constexpr unsigned kLines = 1;

/// Every outline's JSON is padded to this, so that the size follows from the counts. With the
/// longest coordinates, origin and first view it has 943 bytes plus what the 9 counts add to one
/// digit each: at most 9 to 12, together 99.
constexpr std::size_t kJsonBytes = 1056;

// The BIN chunk, v vertices and s segments:
//
//   offset  bytes       what
//        0  12 v        positions, 3 f32 each, polyline by polyline
//     12 v  4 s or 8 s  segments, 2 u16 each if v <= 65535, else 2 u32; in the order of the
//     vertices:
//                       (i, i + 1) within a polyline; where i is skipped, a polyline begins at i +
//                       1
struct Sizes {
  std::size_t vertices = 0;
  std::size_t segments = 0;
  std::size_t form_segments = 0;

  bool is_short() const { return vertices <= kMaxShortVertices; }
  std::size_t position_bytes() const { return 12 * vertices; }
  std::size_t index_bytes() const { return (is_short() ? 4 : 8) * segments; }
  std::size_t bin_bytes() const { return position_bytes() + index_bytes(); }
};

Json document_json(const Sizes& sizes, const Bounds& bounds, const Frame& frame,
                   const std::optional<Standpoint>& first_view) {
  Json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "meshhier"}};
  document["extensionsUsed"] = Json::array({kExtension});
  document["scene"] = 0;
  document["scenes"] = Json::array({Json::object()});
  document["extensions"][kExtension] = {{"version", kOutlineVersion},
                                        {"vertexCount", sizes.vertices},
                                        {"segmentCount", sizes.segments}};
  if (sizes.form_segments > 0)
    document["extensions"][kExtension]["formSegmentCount"] = sizes.form_segments;
  if (first_view)
    document["extras"] = first_view_extras(*first_view);
  if (sizes.segments == 0)
    return document;

  const Vec3d min = to_double(bounds.min);
  const Vec3d max = to_double(bounds.max);
  const Json lines = {{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"mode", kLines}};
  const Json mesh = {{"primitives", Json::array({lines})}};
  const Json position = {{"bufferView", 0},
                         {"componentType", kF32},
                         {"count", sizes.vertices},
                         {"type", "VEC3"},
                         {"min", Json::array({min.x, min.y, min.z})},
                         {"max", Json::array({max.x, max.y, max.z})}};
  const Json index = {{"bufferView", 1},
                      {"componentType", sizes.is_short() ? kU16 : kU32},
                      {"count", 2 * sizes.segments},
                      {"type", "SCALAR"}};
  const Json positions = {{"buffer", 0},
                          {"byteOffset", 0},
                          {"byteLength", sizes.position_bytes()},
                          {"target", kVertexTarget}};
  const Json indices = {{"buffer", 0},
                        {"byteOffset", sizes.position_bytes()},
                        {"byteLength", sizes.index_bytes()},
                        {"target", kIndexTarget}};
  const Json buffer = {{"byteLength", sizes.bin_bytes()}};
  document["scenes"][0]["nodes"] = Json::array({0});
  document["nodes"] = Json::array({mesh_node(frame)});
  document["meshes"] = Json::array({mesh});
  document["accessors"] = Json::array({position, index});
  document["bufferViews"] = Json::array({positions, indices});
  document["buffers"] = Json::array({buffer});
  return document;
}

/// Returns the number of segments in the last `lines` polylines.
std::size_t segments_of_last(const Outline& outline, std::size_t lines) {
  const std::size_t first = outline.polyline_count() - lines;
  return outline.vertices.size() - outline.starts[first] - lines;
}

/// Returns how many of the last polylines have `segments` segments together.
std::size_t last_lines(const Outline& outline, std::size_t segments, const std::string& name) {
  std::size_t lines = 0;
  while (lines < outline.polyline_count() && segments_of_last(outline, lines) < segments)
    ++lines;
  if (segments_of_last(outline, lines) != segments) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: its last {} segments are not whole lines", name, segments));
  }
  return lines;
}

void append_segments(std::vector<std::byte>& bin, const Outline& outline, bool is_short) {
  for (std::size_t p = 0; p + 1 < outline.starts.size(); ++p) {
    for (std::uint32_t v = outline.starts[p]; v + 1 < outline.starts[p + 1]; ++v) {
      for (const std::uint32_t index : {v, v + 1}) {
        is_short ? append_little(bin, static_cast<std::uint16_t>(index))
                 : append_little(bin, index);
      }
    }
  }
}

std::vector<Vec3f> read_vertices(std::span<const std::byte> bin, std::size_t count,
                                 const std::string& name) {
  std::vector<Vec3f> vertices(count);
  for (std::size_t v = 0; v < count; ++v) {
    const std::byte* from = bin.data() + 12 * v;
    vertices[v] = {load_little<float>(from), load_little<float>(from + 4),
                   load_little<float>(from + 8)};
    if (!std::isfinite(vertices[v].x) || !std::isfinite(vertices[v].y) ||
        !std::isfinite(vertices[v].z)) {
      throw Error(ErrorCode::corrupt, fmt::format("{}: vertex {} is not finite", name, v));
    }
  }
  return vertices;
}

std::vector<std::uint32_t> read_starts(std::span<const std::byte> bin, const Sizes& sizes,
                                       const std::string& name) {
  const auto index = [&](std::size_t i) -> std::uint64_t {
    const std::byte* from = bin.data() + sizes.position_bytes();
    return sizes.is_short() ? load_little<std::uint16_t>(from + 2 * i)
                            : load_little<std::uint32_t>(from + 4 * i);
  };
  std::vector<std::uint32_t> starts{0};
  std::uint64_t last = 0;  // the vertex that the previous segment ended at
  for (std::size_t s = 0; s < sizes.segments; ++s) {
    const std::uint64_t from = index(2 * s);
    if (s > 0 && from == last + 1)
      starts.push_back(static_cast<std::uint32_t>(from));
    if ((from != last && starts.back() != from) || index(2 * s + 1) != from + 1) {
      throw Error(ErrorCode::corrupt,
                  fmt::format("{}: segment {} is ({}, {}), expected ({}, {}) or ({}, {})", name, s,
                              from, index(2 * s + 1), last, last + 1, last + 1, last + 2));
    }
    last = from + 1;
  }
  const std::uint64_t found = sizes.segments == 0 ? 0 : last + 1;
  if (found != sizes.vertices) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: the segments use {} of {} vertices", name, found, sizes.vertices));
  }
  if (found > 0)
    starts.push_back(static_cast<std::uint32_t>(found));
  return starts;
}

}  // namespace

std::size_t outline_bytes(std::size_t vertex_count, std::size_t segment_count) {
  return glb_bytes(kJsonBytes, Sizes{vertex_count, segment_count, 0}.bin_bytes());
}

std::vector<std::byte> encode_outline(const Outline& outline, const Frame& frame) {
  const std::size_t lines = outline.polyline_count();
  if (outline.form_lines > lines)
    throw Error(ErrorCode::internal, "an outline has more lines of the form than lines");
  const Sizes sizes{outline.vertices.size(), outline.vertices.size() - lines,
                    segments_of_last(outline, outline.form_lines)};
  const Bounds bounds = bounds_of(outline.vertices);
  std::vector<std::byte> bin;
  bin.reserve(sizes.bin_bytes());
  for (const Vec3f& vertex : outline.vertices) {
    append_little(bin, vertex.x);
    append_little(bin, vertex.y);
    append_little(bin, vertex.z);
  }
  append_segments(bin, outline, sizes.is_short());
  if (bin.size() != sizes.bin_bytes()) {
    throw Error(ErrorCode::internal, "an outline has a polyline of fewer than two vertices");
  }
  const std::string json = json_text(document_json(sizes, bounds, frame, outline.first_view));
  if (json.size() > kJsonBytes) {
    throw Error(ErrorCode::internal, "the outline's JSON is longer than its fixed size");
  }
  return join_glb(json, bin, kJsonBytes);
}

Outline decode_outline(std::span<const std::byte> bytes, const std::string& name) {
  const GlbView glb = split_glb(bytes, name);
  const Json document = parse_json(glb.json, name);
  const Json& extension = require_extension(document, kExtension, kOutlineVersion, name);
  const Sizes sizes{require_count(extension, "vertexCount", UINT32_MAX, name),
                    require_count(extension, "segmentCount", UINT32_MAX, name),
                    extension.contains("formSegmentCount")
                        ? require_count(extension, "formSegmentCount", UINT32_MAX, name)
                        : 0};
  if (sizes.bin_bytes() != glb.bin.size()) {
    throw Error(ErrorCode::corrupt, fmt::format("{}: the BIN chunk has {} bytes, expected {}", name,
                                                glb.bin.size(), sizes.bin_bytes()));
  }
  Outline outline;
  outline.vertices = read_vertices(glb.bin, sizes.vertices, name);
  outline.starts = read_starts(glb.bin, sizes, name);
  outline.form_lines = last_lines(outline, sizes.form_segments, name);
  // Any frame will do here: the reader of the hierarchy takes the manifest's.
  const Frame frame = read_frame(document, name);
  outline.first_view = read_first_view(document, name);
  require_same_json(document_json(sizes, bounds_of(outline.vertices), frame, outline.first_view),
                    document, name);
  return outline;
}

}  // namespace meshhier::storage
