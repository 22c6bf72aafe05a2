// Finds the wedges of a contracted tile, and which old wedges they stand for (docs/decisions/025).
//
// Problem. Methods contract places and know nothing of wedges. Several old places, each with its
// wedges, have become one: mixing all of them would blend textures across seams and round off hard
// edges; keeping all would pile up copies.
//
// Idea. After any method, a new place gets a wedge for each combination that some corner around it
// shows:
//
//      old wedges of the new place     chart    normals    colours      new wedges
//         o1  area 5                     A      group 1    group 1      (A, 1, 1)  for o1 and o2
//         o2  area 3                     A      group 1    group 1
//         o3  area 4                     A      group 2    group 1      (A, 2, 1)
//         o4  area 2                     B      group 2    group 1      (B, 2, 1)
//
//   - A chart is a set of wedges that edges or equal texture coordinates join (texture_charts.h).
//   - Groups are made by leaders: the wedge that shows the largest area leads; one that differs
//   from
//     all leaders by too much becomes one (attribute_groups.h).
//   - Labels do not mix: wedges with different ones stay apart. So a triangle that survives keeps
//     its object, which all of its corners have.
//
// So textures do not blend across seams, hard edges stay hard, and shading stays smooth across a
// seam of the texture.
//
// Invariant. Each old wedge maps to one new wedge of its place's parent, and each triangle that
// survives shows combinations that exist. Order and choice follow areas and the old wedges' order,
// never addresses or time.
#pragma once

#include "cluster_simplify/seams.h"
#include "cluster_simplify/wedge_options.h"
#include "hierarchy/attribute_rules.h"
#include "hierarchy/build_tile.h"

#include <vector>

namespace meshhier::cluster_simplify {

/// The wedges at the representatives of a contraction, by its numbers.
struct ContractedWedges {
  std::vector<float> attributes;  ///< of the first wedge of each, as VertexArray's
  Copies copies;
  WedgeMap map;  ///< of all own places and their copies
};

/// Required if `joined` has copies, or objects, pieces of which a method may bring to one place.
/// Representatives keep what the contraction gave them if no
/// triangle shows them any more, or if their places had no copies and are one piece of surface, of
/// one chart. Other places have wedges that triangles show, in the order of the first old wedges
/// that they stand for; no two are equal.
/// Old wedges without a triangle that survives go to the nearest of their chart, or of their place.
/// Pure, deterministic; O(n log n), however many wedges or triangles meet at a place.
ContractedWedges contract_wedges(const BuildTile& joined, const Contraction& contraction,
                                 const AttributeRules& rules, const WedgeOptions& options);

}  // namespace meshhier::cluster_simplify
