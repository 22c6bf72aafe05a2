// The codecs of EXT_meshopt_compression (Khronos, ratified 2021), which are meshoptimizer's.
//
// All are deterministic for one version of the library, and thread-safe. Decoders take bytes that
// nobody vouches for: they return false if these are no stream of that length, and never access
// anything else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::storage {

/// A byte of a stream of attributes stands for at most so many: 64 vertices' bytes have 2 bits a 16
/// of them.
inline constexpr std::uint64_t kMostAttributeBytes = 64;

/// Encodes in mode ATTRIBUTES. Requires `plain` to be a positive number of elements of `stride`
/// bytes, a multiple of 4 up to 256.
std::vector<std::byte> encode_attributes(std::span<const std::byte> plain, std::size_t stride);
bool decode_attributes(std::span<const std::byte> packed, std::size_t stride,
                       std::span<std::byte> plain);

/// The vertices that triangles have. Those behind the boundary are numbered as they are first used,
/// if the tile is made so (pipeline/tiles/vertex_order.h).
struct VertexCounts {
  std::size_t all = 0;
  std::size_t boundary = 0;
};

/// Encodes in mode TRIANGLES: decoding gives the same triangles in another order, turned. It takes
/// the one that packs better of two orders that are good for the GPU's vertex cache: one by scores
/// (meshoptimizer's variant of Forsyth 2006) and the one in which vertices are numbered. `corners`:
/// 3 a triangle, each below `counts.all`; not empty.
std::vector<std::byte> encode_triangles(std::span<const std::uint32_t> corners,
                                        const VertexCounts& counts);
/// Decodes triangles, 3 corners each. Corners may be any numbers: the caller checks them.
bool decode_triangles(std::span<const std::byte> packed, std::span<std::uint32_t> corners);

/// Returns the triangles in an order for the GPU's vertex cache, by fans (Sander, Nehab & Barczak
/// 2007). Requires corners below `vertex_count`. Deterministic for one version of the library.
/// O(n).
std::vector<std::uint32_t> vertex_cache_order(std::span<const std::uint32_t> corners,
                                              std::size_t vertex_count);

/// Encodes in mode INDICES: any numbers; those near each other take less.
std::vector<std::byte> encode_indices(std::span<const std::uint32_t> numbers);
bool decode_indices(std::span<const std::byte> packed, std::span<std::uint32_t> numbers);

/// The filter EXPONENTIAL has floats as 8 bits of exponent and 24 of mantissa, both signed, here
/// one exponent for each of three axes. Turns the little endian floats of `positions`, 3 a vertex,
/// into such words; returns false, and changes nothing, if any would not come back bit for bit.
bool try_filter_positions(std::span<std::byte> positions);
/// Turns such words, which may be any, into floats; returns false for exponents outside -100 to
/// 100, on which decoders differ.
bool unfilter_positions(std::span<std::byte> positions);

}  // namespace meshhier::storage
