// Angles by arithmetic whose result IEEE 754 fixes.
//
// The C library picks its sine and arc tangent by processor, and their last bits differ. What
// decides a result takes these: sums, products, quotients and square roots are equal everywhere.
#pragma once

namespace meshhier {

/// A point of the unit circle.
struct UnitTurn {
  double cosine = 1;
  double sine = 0;
};

/// The turn by an angle from -2 pi to 2 pi, off by less than 1e-14.
UnitTurn turn_by(double angle);

/// The angle from 0 to pi of the direction (x, y), y >= 0, off by less than 1e-14; 0 of (0, 0).
/// Requires that the sum of the squares is in range.
double angle_of(double x, double y);

}  // namespace meshhier
