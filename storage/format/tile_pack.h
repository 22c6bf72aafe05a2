// A tile's BIN chunk with compressed sections (EXT_meshopt_compression), from the plain one and
// back.
#pragma once

#include "storage/format/tile_plan.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace meshhier::storage {

struct PackedBin {
  Packing packing;
  std::vector<std::byte> bin;
};

/// Compresses `plain`, the BIN chunk of `plan`. Deterministic for one version of meshoptimizer.
PackedBin pack_bin(const TilePlan& plan, std::span<const std::byte> plain);

/// Reads what the JSON of a tile says of its compressed sections, as far as it does not follow from
/// the plan. Nobody vouches for the document: checks that the sections' bytes are those of `bin`,
/// and that no section asks for more memory than its codec can have made of so many bytes. Throws
/// Error(corrupt) that starts with `name`.
Packing read_packing(const nlohmann::ordered_json& document, const TilePlan& plan,
                     std::span<const std::byte> bin, const std::string& name);

/// Returns the plain BIN chunk. Triangles come in another order than pack_bin() was given, turned;
/// corners may be any numbers. Requires a packing from read_packing(). Throws Error(corrupt) that
/// starts with `name`.
std::vector<std::byte> unpack_bin(const TilePlan& plan, const Packing& packing,
                                  std::span<const std::byte> bin, const std::string& name);

}  // namespace meshhier::storage
