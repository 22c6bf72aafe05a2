// Implicit tiles (OGC, 3D Tiles 1.1, "Implicit Tiling") as tiles that a document lists.
//
// Problem. All that picks, places and counts tiles knows lists of them; implicit ones are bits in
// subtrees, each of which may be a file of its own.
//
// Idea. From each root of a subtree down, the children that there are become tiles behind those of
// the document, and child subtrees wait until it is done:
//
//       waiting:  3/0/4   3/1/5 ...            one subtree in memory at a time
//       document: ... parent, its children, theirs, ...        parents first
//
// A template such as "{level}/{x}/{y}.glb" becomes the name of each content that there is. Nothing
// is opened but subtrees, and of these only such as a parent says there are.
//
// Invariant. What follows of the document is what it would be if it listed the same tiles.
#pragma once

#include "mesh_io/tileset_document.h"
#include "mesh_io/tileset_room.h"

namespace meshhier::mesh_io {

/// Adds the implicit tiles of a document to its list. `open`: opens the files that it names. Throws
/// Error(input) naming file and place if a subtree is missing or broken, or if the document gets
/// more than `room` has; as read_subtree().
void expand_implicit_tiles(TilesetDocument& document, const TilesetRoom& room,
                           const OpenNamed& open);

}  // namespace meshhier::mesh_io
