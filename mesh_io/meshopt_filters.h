// Undoes the filters of EXT_meshopt_compression whose results meshoptimizer lets the processor
// decide.
//
// Its vector code takes approximate roots and, on ARM, fused multiplications. This takes floats,
// and products and roots that IEEE 754 fixes: the numbers of meshoptimizer on x86-64, but for
// octahedral bytes, which may differ from its approximation by 1.
#pragma once

#include <cstddef>
#include <span>

namespace meshhier::mesh_io {

/// Turns octahedral directions into unit vectors, in place: elements of four int8 (stride 4) or
/// int16 (stride 8), of which the fourth stays. A direction without length becomes 0, 0, 0.
/// Requires whole elements, little endian.
void undo_octahedral(std::span<std::byte> elements, std::size_t stride);

/// Turns quaternions without their largest component into whole ones, in place: four int16 each.
/// Requires whole elements, little endian.
void undo_quaternion(std::span<std::byte> elements);

}  // namespace meshhier::mesh_io
