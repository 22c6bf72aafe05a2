// Numbers of property tables and batch tables.
#pragma once

#include "hierarchy/object_row.h"
#include "mesh_io/gltf_bytes.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

enum class NumberType : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
/// Returns the type that EXT_structural_metadata or a batch table calls so: "UINT8",
/// "UNSIGNED_BYTE".
std::optional<NumberType> number_type_of(std::string_view name);
std::size_t bytes_of(NumberType type);
bool is_whole(NumberType type);

/// Returns the little endian number at the start of `bytes`; integers that no double holds as text.
ObjectValue number_in(NumberType type, std::span<const std::byte> bytes);
/// Returns a fraction of the largest number of an integer type, as normalized ones are.
double fraction_of(NumberType type, double number);

/// Reads parts of bytes that lie near those of the call before, through a window. For one thread.
class ByteParts {
 public:
  explicit ByteParts(GltfRange range) : range_(range) {}

  std::uint64_t size() const { return range_.size; }
  /// Returns a part, valid until the next call. Requires that it is there.
  std::span<const std::byte> at(std::uint64_t offset, std::size_t bytes);

 private:
  static constexpr std::size_t kWindow = std::size_t{1} << 14;
  GltfRange range_;
  std::uint64_t first_ = 0;
  std::vector<std::byte> window_;
};

}  // namespace meshhier::mesh_io
