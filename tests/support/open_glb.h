// A tile's file taken apart, to be damaged.
#pragma once

#include "storage/format/glb.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::tests {

/// The JSON of a GLB and its parts, to be changed and put together again.
struct OpenGlb {
  explicit OpenGlb(const std::vector<std::byte>& bytes) {
    const auto view = storage::split_glb(bytes, "open");
    json = nlohmann::ordered_json::parse(view.json);
    bin.assign(view.bin.begin(), view.bin.end());
  }
  std::vector<std::byte> close() const { return storage::join_glb(json.dump(), bin); }
  nlohmann::ordered_json& extension() { return json["extensions"]["MESHHIER_tile"]; }
  /// First byte of the buffer view that the extension names so.
  std::byte* view(const char* key) { return bytes_of_view(extension()[key].get<int>()); }
  std::byte* attribute(const char* key) {
    return bytes_of_view(json["meshes"][0]["primitives"][0]["attributes"][key].get<int>());
  }
  std::byte* indices(int primitive) {
    return bytes_of_view(json["meshes"][0]["primitives"][primitive]["indices"].get<int>());
  }
  std::byte* bytes_of_view(int view) {
    return bin.data() + json["bufferViews"][view]["byteOffset"].get<std::size_t>();
  }

  nlohmann::ordered_json json;
  std::vector<std::byte> bin;
};

inline void store_u16(std::byte* at, unsigned value) {
  storage::store_little(static_cast<std::uint16_t>(value), at);
}
inline void store_u32(std::byte* at, std::uint32_t value) {
  storage::store_little(value, at);
}
inline void store_nan(std::byte* at) {
  storage::store_little(std::numeric_limits<float>::infinity(), at);
}

inline unsigned load_u16(const std::byte* at) {
  return storage::load_little<std::uint16_t>(at);
}

inline void store_triangle(std::byte* at, std::array<unsigned, 3> corners) {
  for (std::size_t c = 0; c < 3; ++c)
    store_u16(at + 2 * c, corners[c]);
}

/// A colour's channel of 16 bits.
inline void make_white(std::byte* channel) {
  channel[0] = channel[1] = std::byte{255};
}

}  // namespace meshhier::tests
