// The disk that a build will take: the bytes that its stages write, added up for each moment.
//
// Data that the journal names, chunks and all that is made of them, is on disk whatever the budget.
// The rest is on disk as far as the memory pool does not hold it.
#pragma once

#include "pipeline/plan/stage_cost.h"

#include <cstdint>

namespace meshhier::pipeline {

/// Bytes on disk. They are expected ones for a surface, whose tiles have borders as scans have
/// them: a few per cent above measured ones. It makes no difference that counts whether triangles
/// refer to vertices in order or at random.
struct DiskNeed {
  std::uint64_t temporary_bytes = 0;  ///< the most that lies in temporary files at once
  std::uint64_t output_bytes = 0;     ///< the published files'
  std::uint64_t room_bytes = 0;       ///< the most that lies on disk at once, both kinds together
};

/// Returns the bytes of temporary files at one moment, with a memory pool of `pool_bytes`.
double temporary_bytes_at(DiskMoment moment, const DiskVolumes& volumes, std::uint64_t pool_bytes);

DiskNeed predict_disk(const DiskCosts& costs, std::uint64_t pool_bytes);

}  // namespace meshhier::pipeline
