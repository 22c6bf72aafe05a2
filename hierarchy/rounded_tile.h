// Rounds a tile to a lattice, and tells what that does to the bound that it had.
#pragma once

#include "hierarchy/lattice.h"
#include "hierarchy/tile_mesh.h"

namespace meshhier {

/// Moves all vertices, ghosts and copies too, to their nearest points; returns the largest distance
/// that one went.
double round_to(const Lattice& lattice, TileMesh& mesh);

/// Makes a bound of exact positions one of rounded ones. Where rounding is nearly all of it, the
/// levels below still tell it from the children's.
float bound_with_rounding(float bound, double rounding, int levels_below);

}  // namespace meshhier
