#include "cluster_simplify/contraction.h"

#include "cluster_simplify/attribute_seams.h"
#include "cluster_simplify/cluster.h"
#include "cluster_simplify/edge_collapse.h"
#include "cluster_simplify/half_edge.h"
#include "cluster_simplify/majority_labels.h"
#include "hierarchy/error.h"
#include "hierarchy/value_mixer.h"

#include <algorithm>

namespace meshhier::cluster_simplify {

namespace {

Contraction contract_places(const BuildTile& joined, std::uint32_t target,
                            const AttributeLayout& layout, const ContractionOptions& options) {
  const auto seams = [&] { return attribute_seams(joined, layout, options.wedges); };
  switch (options.method) {
    case Method::cluster:
      return cluster(joined, target, layout, options.representative);
    case Method::edge_collapse:
      return edge_collapse(joined, target, layout, seams());
    case Method::half_edge:
      return half_edge(joined, target, options.cost, seams());
  }
  throw Error(ErrorCode::internal, "unknown contraction method");
}

}  // namespace

Contraction contract(const BuildTile& joined, std::uint32_t target, const AttributeLayout& layout,
                     const ContractionOptions& options) {
  Contraction contraction = contract_places(joined, target, layout, options);
  if (options.method != Method::half_edge && ValueMixer(layout).has_labels())
    choose_majority_labels(joined, layout, contraction);
  return contraction;
}

}  // namespace meshhier::cluster_simplify
