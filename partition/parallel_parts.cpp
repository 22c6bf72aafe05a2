#include "partition/parallel_parts.h"

#include <algorithm>

#include <tbb/parallel_for.h>

namespace meshhier::partition {

void for_each_part(std::uint64_t count, std::uint64_t part,
                   const std::function<void(std::uint64_t, std::uint64_t)>& work) {
  tbb::parallel_for(std::uint64_t{0}, count / part + (count % part > 0 ? 1 : 0),
                    [&](std::uint64_t i) { work(i * part, std::min(part, count - i * part)); });
}

}  // namespace meshhier::partition
