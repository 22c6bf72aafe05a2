#include "drawing/line_chains.h"

#include <algorithm>
#include <array>

namespace meshhier::drawing {

void LineChains::meet(std::span<const std::uint32_t> ends) {
  std::array<std::vector<std::uint32_t>, 2> kinds;
  for (const std::uint32_t end : ends)
    kinds[end % 2].push_back(end);
  const std::size_t pairs = std::min(kinds[0].size(), kinds[1].size());
  for (std::size_t i = 0; i < pairs; ++i)
    join(kinds[0][i], kinds[1][i]);
  const std::vector<std::uint32_t>& rest = kinds[0].size() > pairs ? kinds[0] : kinds[1];
  for (std::size_t i = pairs; i + 1 < rest.size(); i += 2)
    join(rest[i], rest[i + 1]);
}

}  // namespace meshhier::drawing
