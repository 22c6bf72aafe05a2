// Streaming exact selection: the k-th smallest of more keys than fit in memory.
#pragma once

#include "partition/split_plane.h"

#include <cstdint>
#include <functional>
#include <span>

namespace meshhier::partition {

/// Visits all keys, in blocks, in any order; can be called again.
using KeySource = std::function<void(const std::function<void(std::span<const SplitKey>)>&)>;

/// The key with exactly k smaller ones. Keys are distinct (ids are), k < count. Reads the source
/// once if `memory_bytes` hold all keys; else histograms of the projection's bits (then of the ids
/// among equal projections) narrow the range first: 16 bits a pass, at most seven passes, whatever
/// the distribution. Memory: memory_bytes, at least 1 MiB.
SplitKey select(const KeySource& keys, std::uint64_t count, std::uint64_t k,
                std::uint64_t memory_bytes);

}  // namespace meshhier::partition
