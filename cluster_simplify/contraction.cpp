#include "cluster_simplify/contraction.h"

#include "cluster_simplify/cluster.h"
#include "cluster_simplify/edge_collapse.h"
#include "cluster_simplify/half_edge.h"
#include "hierarchy/error.h"

#include <algorithm>

namespace meshhier::cluster_simplify {

Contraction contract(const BuildTile& joined, std::uint32_t target, const AttributeLayout& layout,
                     const ContractionOptions& options) {
  switch (options.method) {
    case Method::cluster:
      return cluster(joined, target, layout, options.representative);
    case Method::edge_collapse:
      return edge_collapse(joined, target, layout);
    case Method::half_edge:
      return half_edge(joined, target, options.cost);
  }
  throw Error(ErrorCode::internal, "unknown contraction method");
}

std::uint32_t contraction_target(std::uint32_t own_count, std::uint32_t asked) {
  return std::max(1U,
                  std::min(asked, static_cast<std::uint32_t>(std::uint64_t{own_count} * 3 / 4)));
}

}  // namespace meshhier::cluster_simplify
