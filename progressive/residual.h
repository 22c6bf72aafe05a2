// Residuals are the differences of a vertex's values from those of another vertex, which are known.
//
// Nothing is lost: values are compared as integers of value_bytes() bytes. Floats become integers
// that ascend with them (sign and magnitude turned to one scale, as in Lindstrom & Isenburg, "Fast
// and Efficient Compression of Floating-Point Data", 2006, section 3.1); 8 and 16 bit colours are
// integers. The difference, around the end of the scale if need be, is folded so that small ones of
// either sign are small numbers.
#pragma once

#include "hierarchy/attributes.h"

#include <cstdint>
#include <span>

namespace meshhier::progressive {

/// Computes the residuals of one vertex. `values`, `predicted` and `residuals`:
/// vertex_values(layout) each.
void find_residuals(const AttributeLayout& layout, std::span<const float> values,
                    std::span<const float> predicted, std::span<std::uint32_t> residuals);

/// Returns the values, bit for bit. A residual's bits beyond value_bytes() do not count.
void add_residuals(const AttributeLayout& layout, std::span<const std::uint32_t> residuals,
                   std::span<const float> predicted, std::span<float> values);

}  // namespace meshhier::progressive
