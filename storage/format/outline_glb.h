// The outline as a glTF 2.0 binary with one LINES primitive (docs/file_format.md).
#pragma once

#include "hierarchy/frame.h"
#include "hierarchy/outline.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// Returns the bytes of the file that encode_outline makes of so many vertices and line segments;
/// exact, so that an outline can be cut to a budget before it is encoded.
std::size_t outline_bytes(std::size_t vertex_count, std::size_t segment_count);

/// Returns the file's bytes. Deterministic. An outline without polylines gives a valid file with an
/// empty scene.
std::vector<std::byte> encode_outline(const Outline& outline, const Frame& frame);

/// Parses a file that nobody vouches for. Throws Error(corrupt) that starts with `name`.
Outline decode_outline(std::span<const std::byte> bytes, const std::string& name);

}  // namespace meshhier::storage
