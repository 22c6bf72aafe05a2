#include "base/angle.h"

#include <cmath>

namespace meshhier {
namespace {

/// Up to pi / 4. Lambert's continued fraction: with 9 terms the rest is below 1e-17.
double tangent(double angle) {
  constexpr int kTerms = 9;
  const double square = angle * angle;
  double rest = 2 * kTerms + 1;
  for (int term = 2 * kTerms - 1; term > 0; term -= 2)
    rest = term - square / rest;
  return angle / rest;
}

/// Up to tan(pi / 8). Gauss's continued fraction: a term is worth a 25th of the one before.
double arc_tangent(double tangent) {
  constexpr int kTerms = 12;
  const double square = tangent * tangent;
  double rest = 2 * kTerms + 1;
  for (int term = kTerms; term > 0; --term)
    rest = 2 * term - 1 + term * term * square / rest;
  return tangent / rest;
}

UnitTurn doubled(UnitTurn turn) {
  return {(turn.cosine - turn.sine) * (turn.cosine + turn.sine), 2 * turn.cosine * turn.sine};
}

}  // namespace

UnitTurn turn_by(double angle) {
  const double quarter = tangent(angle / 8);  // the tangent of half a quarter of the angle
  const double divisor = 1 + quarter * quarter;
  return doubled(doubled({(1 - quarter * quarter) / divisor, 2 * quarter / divisor}));
}

double angle_of(double x, double y) {
  const double size = std::sqrt(x * x + y * y);
  if (!(size > 0))
    return 0;
  // Half the angle is that of (size + x, y), or of (y, size - x): the one without cancellation.
  const double along = x >= 0 ? size + x : y;
  const double beside = x >= 0 ? y : size - x;
  const double half_size = std::sqrt(along * along + beside * beside);
  const double quarter = beside / (half_size + along);  // up to tan(pi / 4)
  const double eighth = quarter / (1 + std::sqrt(1 + quarter * quarter));
  return 8 * arc_tangent(eighth);
}

}  // namespace meshhier
