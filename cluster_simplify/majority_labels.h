// Labels of representatives.
#pragma once

#include "cluster_simplify/seams.h"
#include "hierarchy/attributes.h"
#include "hierarchy/build_tile.h"

namespace meshhier::cluster_simplify {

/// Gives each representative, of each label, the one that covers most of the surface of those that
/// it stands for: a triangle counts a third at each corner. Among equal areas that of most places,
/// then the least. Of places with copies the first wedge's counts. What is no number is no label.
/// O(n log n) a label.
void choose_majority_labels(const BuildTile& joined, const AttributeLayout& layout,
                            Contraction& contraction);

}  // namespace meshhier::cluster_simplify
