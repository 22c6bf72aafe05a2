#include "pipeline/plan/disk_need.h"

#include <algorithm>

namespace meshhier::pipeline {
namespace {

std::uint64_t whole(double bytes) {
  return static_cast<std::uint64_t>(std::max(0.0, bytes));
}

}  // namespace

double temporary_bytes_at(DiskMoment moment, const DiskVolumes& volumes, std::uint64_t pool_bytes) {
  const auto is_there = [&](const DiskVolume& volume) {
    return volume.from <= moment && moment <= volume.until;
  };
  double pooled = 0;
  for (const DiskVolume& volume : volumes)
    pooled += volume.pooled && is_there(volume) ? volume.bytes : 0;
  // The pool takes what comes first and frees it with its spool; a file shrinks at its end only.
  double bytes = std::max(0.0, pooled - static_cast<double>(pool_bytes));
  for (const DiskVolume& volume : volumes)
    bytes += !volume.pooled && is_there(volume) ? volume.bytes : 0;
  return bytes;
}

DiskNeed predict_disk(const DiskCosts& costs, std::uint64_t pool_bytes) {
  const auto at = [&](DiskMoment moment) {
    return temporary_bytes_at(moment, costs.volumes, pool_bytes);
  };
  const double simplify = at(DiskMoment::simplify);
  const double temporary = std::max({at(DiskMoment::splits), at(DiskMoment::triangles),
                                     at(DiskMoment::noted), at(DiskMoment::leaves), simplify});
  const OutputCost& output = costs.output;
  // The room is for tiles that do not compress at all.
  const double room = std::max(temporary, simplify + output.plain_bytes + output.slack_bytes);
  if (!costs.packed)
    return {whole(temporary), whole(output.bytes), whole(room)};
  // The published files are temporary then, and lie beside the archive when all else is gone.
  const double overhead = costs.archive_overhead_bytes;
  return {whole(std::max(temporary, simplify + output.bytes)), whole(output.bytes + overhead),
          whole(std::max(room, 2 * output.plain_bytes + output.slack_bytes + overhead))};
}

}  // namespace meshhier::pipeline
