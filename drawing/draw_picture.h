// The picture of a plan, an elevation or a section at a scale, as PNG.
//
// Problem. At 1:50 and 300 dots an inch a house has 10^8 pixels, and its model more triangles than
// memory holds.
// Idea. Orthophotos are drawn from above, window by window, each from the tiles over it, at the
// level that fits a pixel (export/orthophoto.h). A turned frame (view.h) makes any side "above". On
// each window the lines of the cut are laid as strokes, and what lies before the cut is clipped
// away; then grid, scale bar and numbers. A row of windows is a band, whose rows are written.
//
//    tiles over a window -> segments of the cut -> strokes
//                        -> clipped at the cut  -> pixels -> strokes laid on -> band -> PNG
//
// Invariant. The file is the same for any number of threads and any budget; complete or not there.
//
// Cost. A tile is read once for each window that it touches. Memory: a band, and for each thread a
// window and a tile.
#pragma once

#include "drawing/drawing.h"

namespace meshhier::drawing {

/// The longest side of a picture, pixels: 8 m of paper at 300 dots an inch.
inline constexpr std::uint32_t kMostPictureSide = 100000;

/// Draws the picture and returns a text for people. Throws as draw().
std::string draw_picture(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                         const DrawingOptions& options, execution::Progress& progress,
                         const execution::CancelToken& cancel);

}  // namespace meshhier::drawing
