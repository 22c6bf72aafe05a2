// The numbers of Draco's attributes, equal on all machines.
#pragma once

namespace draco {
class PointAttribute;
}

namespace meshhier::mesh_io {

/// Computes the floats of an attribute anew, from the whole numbers that its stream holds.
///
/// The library's own may differ in the last bit: where it is compiled for ARM, its products and
/// sums are rounded once, on x86-64 twice. These are rounded twice. `attribute` is left as it is if
/// it has no floats, or `whole` (draco's portable attribute) was not made of any.
/// @param whole null if the stream holds the numbers themselves
void compute_floats(const draco::PointAttribute* whole, draco::PointAttribute& attribute);

}  // namespace meshhier::mesh_io
