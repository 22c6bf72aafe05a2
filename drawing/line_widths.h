// How wide lines are, in millimetres of paper.
#pragma once

namespace meshhier::drawing {

// As on maps: an index contour is about three times as wide as others.
inline constexpr double kContourWidth = 0.13, kIndexWidth = 0.35, kSectionWidth = 0.35;

}  // namespace meshhier::drawing
