// Hashes vertices as two tiles must both know them, to 64 bits. Unlike ones are equal by accident
// as rarely as a damaged file keeps its checksum.
#pragma once

#include "export/tile_vertices.h"
#include "storage/io/hash.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace meshhier::exporting {

class VertexHash {
 public:
  /// Hashes chain and position, and attributes and normal if `with_attributes`. `normal`: one or
  /// none.
  std::uint64_t operator()(std::span<const std::uint16_t> chain, const VertexAt& vertex,
                           std::span<const NormalCode> normal, bool with_attributes) {
    bytes_.clear();
    append(chain);
    append(std::span(&vertex.position(), 1));
    if (with_attributes) {
      append(vertex.attributes());
      append(normal);
    }
    return storage::checksum(bytes_);
  }

 private:
  template <class T>
  void append(std::span<const T> values) {
    const std::size_t end = bytes_.size();
    bytes_.resize(end + values.size_bytes());
    if (!values.empty())
      std::memcpy(bytes_.data() + end, values.data(), values.size_bytes());
  }

  std::vector<std::byte> bytes_;
};

}  // namespace meshhier::exporting
