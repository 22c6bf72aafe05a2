// Cut lines of a hierarchy as a file of lines: sections, and contour lines of terrains.
//
// Problem. The model, and what lines it has, are more than memory holds.
// Idea. Tile by tile in parallel, of those that the levels pass; then joined (line_store.h); then
// written, line by line.
//
// Invariant. The file depends on hierarchy and options alone: the same for any number of threads
// and any budget. It is complete or not there.
//
// Cost. A tile is read once. Memory: for each thread a tile with its segments, and LineStore's.
#pragma once

#include "drawing/drawing.h"
#include "drawing/line_formats.h"

namespace meshhier::drawing {

/// Draws the lines and returns a text for people. Throws as draw().
std::string draw_lines(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                       const DrawingOptions& options, const LineFormat& format,
                       execution::Progress& progress, const execution::CancelToken& cancel);

}  // namespace meshhier::drawing
