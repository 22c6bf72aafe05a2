// The parts that published files have in common: the GLB container (Khronos, glTF 2.0
// specification, section 4.4; docs/file_format.md), JSON that nobody vouches for, the node with the
// frame of coordinates, the first view.
#pragma once

#include "hierarchy/frame.h"
#include "hierarchy/standpoint.h"
#include "storage/io/little_endian.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace meshhier::storage {

// Component types and buffer view targets of the glTF 2.0 specification.
inline constexpr unsigned kI8 = 5120;
inline constexpr unsigned kU8 = 5121;
inline constexpr unsigned kI16 = 5122;
inline constexpr unsigned kU16 = 5123;
inline constexpr unsigned kU32 = 5125;
inline constexpr unsigned kF32 = 5126;
constexpr std::uint64_t component_bytes(unsigned component) {
  return component <= kU8 ? 1 : component <= kU16 ? 2 : 4;
}
/// The accessor type of so many components, 1 to 4.
constexpr const char* vector_type(std::size_t components) {
  constexpr std::array<const char*, 5> kTypes{"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  return kTypes[components];
}
inline constexpr unsigned kVertexTarget = 34962;
inline constexpr unsigned kIndexTarget = 34963;

/// The most vertices whose indices take 16 bits: 65535 is no index, it restarts primitives.
inline constexpr std::uint64_t kMaxShortVertices = 65535;

/// Returns the next multiple of 4, the alignment of everything in a GLB.
constexpr std::uint64_t aligned4(std::uint64_t bytes) {
  return (bytes + 3) / 4 * 4;
}

/// Parses JSON that nobody vouches for. Throws Error(corrupt) that starts with `name` if it is not
/// JSON, or is nested deeper or has more keys than any published file.
nlohmann::ordered_json parse_json(std::string_view text, const std::string& name);

/// Throws Error(corrupt) that starts with `name` and names the first place where `found` is not
/// equal to `expected` as a JSON value; numbers are compared by value.
void require_same_json(const nlohmann::ordered_json& expected, const nlohmann::ordered_json& found,
                       const std::string& name);

/// Returns the unsigned integer `object[key]`. Throws Error(corrupt) that starts with `name` if it
/// is missing or not in 0 .. max.
std::uint64_t require_count(const nlohmann::ordered_json& object, const char* key,
                            std::uint64_t max, const std::string& name);

/// Returns the document's extension of that name. Throws Error(corrupt) that starts with `name` if
/// there is none, or its version is not `version`.
const nlohmann::ordered_json& require_extension(const nlohmann::ordered_json& document,
                                                const char* extension, unsigned version,
                                                const std::string& name);

/// Returns `{"mesh": 0}`, with a translation if the origin is not zero and a scale of all axes if
/// it is not 1; or with the matrix that also turns z-up positions.
nlohmann::ordered_json mesh_node(const Frame& frame, double scale = 1);

/// Returns the frame that node 0 of a document has; the default one if there is no node. Throws
/// Error(corrupt) that starts with `name` if its numbers are missing or not finite; whether it is a
/// node that mesh_node() writes, the caller finds by writing it again.
Frame read_frame(const nlohmann::ordered_json& document, const std::string& name);

/// Returns `{"firstView": [azimuth, elevation]}`, the extras of a document with a first view.
nlohmann::ordered_json first_view_extras(const Standpoint& view);

/// Returns the first view that a document has; nothing if it has no extras. Throws Error(corrupt)
/// that starts with `name` if first_view_extras() does not write such extras.
std::optional<Standpoint> read_first_view(const nlohmann::ordered_json& document,
                                          const std::string& name);

/// The two chunks of a GLB, pointing into its bytes.
struct GlbView {
  std::string_view json;
  std::span<const std::byte> bin;  ///< empty if there is no BIN chunk
};

/// Returns a GLB of a JSON chunk, padded with spaces to at least `json_bytes`, and a BIN chunk,
/// which is left out if `bin` is empty. Requires bin.size() to be a multiple of 4.
std::vector<std::byte> join_glb(std::string_view json, std::span<const std::byte> bin,
                                std::size_t json_bytes = 0);

/// Returns the same with `bin_bytes` zeros as BIN chunk at its end, to be filled in. Requires
/// bin_bytes to be a multiple of 4.
std::vector<std::byte> begin_glb(std::string_view json, std::size_t bin_bytes,
                                 std::size_t json_bytes = 0);

/// Returns the bytes of the GLB that join_glb() makes of chunks of these sizes.
constexpr std::uint64_t glb_bytes(std::uint64_t json_bytes, std::uint64_t bin_bytes) {
  return 12 + 8 + aligned4(json_bytes) + (bin_bytes > 0 ? 8 + aligned4(bin_bytes) : 0);
}

/// Finds the chunks in a GLB that nobody vouches for; the JSON chunk may not exceed 64 KiB. Throws
/// Error(corrupt) that starts with `name` and says at which byte what was expected.
GlbView split_glb(std::span<const std::byte> bytes, const std::string& name);

}  // namespace meshhier::storage
