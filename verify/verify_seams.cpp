// Looks for cracks in random cuts.
//
// All of this is by place: attributes that differ at one place open no edge. A cut shows the image
// of the original mesh under a map of places, one of exact duplicates kept. Say that an edge is
// unbalanced if unequal numbers of triangles run along it in the two directions. If an edge of the
// cut has a single triangle, all images of triangles there are copies of that one, so they do not
// balance; the sum over the original edges that came there is not zero; so one of these is
// unbalanced. Hence: every edge with a single triangle is the image of an unbalanced original edge:
// no cut has more border edges than the input has unbalanced ones, and where there is none (closed,
// oriented input), no cut has a border. Triangles with a place twice are balanced along every edge,
// and have no image.
#include "base/error.h"
#include "base/plain_text.h"
#include "export/cut_mesh.h"
#include "export/random_cut.h"
#include "hierarchy/cut.h"
#include "verify/edge_census.h"
#include "verify/verify_parts.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

using EdgeSpool = storage::RecordSpool<CutEdge>;
using EdgeSort = partition::ExternalSort<CutEdge, CutEdgeKey>;

/// An original edge of which one end has become its image.
struct HalfImage {
  std::uint32_t vertex = 0;  ///< the other end, as the original numbers it
  std::uint32_t image = 0;
};
struct HalfKey {
  std::uint32_t operator()(const HalfImage& half) const { return half.vertex; }
};
using HalfSort = partition::ExternalSort<HalfImage, HalfKey>;

constexpr std::size_t kEdgeSpoolBlockBytes = std::size_t{1} << 18;
/// Edges read from a spool at a time: 512 KiB.
constexpr std::size_t kEdgeBlock = 65536;
/// Cracks of one cut that are told one by one.
constexpr std::uint64_t kToldCracks = 3;

/// The unbalanced edges of the original mesh, corners as vertices of the cut of all partitions.
struct Original {
  exporting::NumberedCut numbered;
  EdgeSpool unbalanced;
  std::uint64_t border_count = 0;
};

template <class Visit>
void census(const VerifyJob& job, const exporting::NumberedCut& numbered, Visit visit) {
  EdgeCensus edges(job.scratch, job.options.memory_budget / 8, visit);
  for (std::size_t i = 0; i < numbered.cut.size(); ++i) {
    job.cancel.check();
    const auto tile = job.tiles.find(numbered.cut[i]);
    if (!tile)
      throw Error(ErrorCode::corrupt, "tile " + to_text(numbered.cut[i]) + " has changed");
    edges.add(*tile, numbered.base(i), exporting::draw_tile(job.tree(), numbered, i, *tile));
  }
  edges.finish();
}

Original look_at_original(const VerifyJob& job) {
  const Tree& tree = job.tree();
  Original original{exporting::number_vertices(job.reader, Cut::of_level(tree, tree.depth())),
                    EdgeSpool(job.scratch, kEdgeSpoolBlockBytes)};
  census(job, original.numbered, [&](const EdgeCount& edge) {
    if (edge.is_unbalanced())
      original.unbalanced.append(edge.edge);
    if (edge.is_border())
      ++original.border_count;
  });
  return original;
}

/// Maps the original vertices to their images in a cut, one partition at a time: asked in ascending
/// order, it walks through the partitions once.
class Images {
 public:
  Images(const VerifyJob& job, ParentMaps& maps, const exporting::NumberedCut& original,
         const exporting::NumberedCut& shown)
      : job_(job), maps_(maps), original_(original), shown_(shown) {}

  /// The number that the cut gives to the image of an original vertex.
  std::uint32_t operator()(std::uint32_t number) {
    if (number < begin_ || number - begin_ >= images_.size())
      enter(original_.position_of_vertex(number));
    return images_[number - begin_];
  }

 private:
  void enter(std::size_t partition) {
    const std::size_t position =
        shown_.cut.position_of(static_cast<PartitionId>(static_cast<std::uint32_t>(partition)));
    NodeId node = original_.cut[partition];
    begin_ = original_.bases[partition];
    images_.resize(original_.bases[partition + 1] - begin_);
    std::iota(images_.begin(), images_.end(), 0U);
    for (; node != shown_.cut[position]; node = job_.tree().parent_tile(node)) {
      const auto map = maps_.get(node);
      for (std::uint32_t& vertex : images_)
        vertex = step(node, *map, vertex);
    }
    for (std::uint32_t& vertex : images_)
      vertex += shown_.base(position);
  }

  static std::uint32_t step(NodeId node, const std::vector<std::uint16_t>& map,
                            std::uint32_t vertex) {
    if (vertex < map.size())
      return map[vertex];
    throw Error(ErrorCode::corrupt,
                fmt::format("tile {}: its parent map has no vertex {}", to_text(node), vertex));
  }

  const VerifyJob& job_;
  ParentMaps& maps_;
  const exporting::NumberedCut& original_;
  const exporting::NumberedCut& shown_;
  std::uint64_t begin_ = 0;
  std::vector<std::uint32_t> images_;  ///< images of one partition's vertices, from begin_ on
};

template <class Visit>
void for_each_edge(const EdgeSpool& edges, Visit visit) {
  std::vector<CutEdge> block;
  for (std::uint64_t first = 0; first < edges.size(); first += block.size()) {
    block.resize(std::min<std::uint64_t>(kEdgeBlock, edges.size() - first));
    edges.read(first, block);
    for (const CutEdge& edge : block)
      visit(edge);
  }
}

/// Adds the images of the unbalanced original edges that are edges still. The low ends are looked
/// up in ascending order, then the high ends: an edge may lead from any partition to any other.
void add_images(const VerifyJob& job, ParentMaps& maps, const Original& original,
                const exporting::NumberedCut& shown, EdgeSort& images) {
  HalfSort halves(job.scratch, job.options.memory_budget / 16);
  Images image(job, maps, original.numbered, shown);
  for_each_edge(original.unbalanced, [&](const CutEdge& edge) {
    halves.add(HalfImage{edge.high, image(edge.low)});
  });
  halves.sort();
  halves.for_each_block([&](std::span<const HalfImage> block) {
    for (const HalfImage& half : block) {
      const std::uint32_t a = half.image, b = image(half.vertex);
      if (a != b)
        images.add(CutEdge{std::min(a, b), std::max(a, b)});
    }
  });
}

/// Sorted edges, one at a time.
class EdgeStream {
 public:
  explicit EdgeStream(EdgeSort& sort) : sort_(sort) {
    sort_.sort();
    block_ = sort_.next_block();
  }
  const CutEdge* now() const { return block_.empty() ? nullptr : block_.data(); }
  void step() {
    block_ = block_.subspan(1);
    if (block_.empty())
      block_ = sort_.next_block();
  }

 private:
  EdgeSort& sort_;
  std::span<const CutEdge> block_;
};

std::string vertex_text(const exporting::NumberedCut& shown, std::uint32_t number) {
  const std::size_t position = shown.position_of_vertex(number);
  return fmt::format("vertex {} of tile {}", number - shown.base(position),
                     to_text(shown.cut[position]));
}

/// Tells of the border edges that are not among the images. Returns how many those are.
std::uint64_t find_cracks(const VerifyJob& job, const exporting::NumberedCut& shown,
                          const std::string& name, EdgeSort& border, EdgeSort& images) {
  EdgeStream borders(border), originals(images);
  std::uint64_t cracks = 0;
  for (; borders.now() != nullptr; borders.step()) {
    const CutEdge edge = *borders.now();
    while (originals.now() != nullptr && originals.now()->key() < edge.key())
      originals.step();
    if (originals.now() != nullptr && *originals.now() == edge)
      continue;
    if (++cracks > kToldCracks)
      continue;
    job.problems.add(
        fmt::format("{}: a crack from {} to {}: one triangle at the edge, and none of "
                    "the input's borders leads there",
                    name, vertex_text(shown, edge.low), vertex_text(shown, edge.high)));
  }
  if (cracks > kToldCracks) {
    job.problems.add(fmt::format("{}: {} in all", name, counted(cracks, "cracks")));
  }
  return cracks;
}

/// Returns how many border edges the cut has.
std::uint64_t look_at_cut(const VerifyJob& job, ParentMaps& maps, const Original& original,
                          std::uint64_t seed) {
  const exporting::NumberedCut shown =
      exporting::number_vertices(job.reader, exporting::random_cut(job.tree(), seed));
  EdgeSort border(job.scratch, job.options.memory_budget / 16);
  census(job, shown, [&](const EdgeCount& edge) {
    if (edge.is_border())
      border.add(edge.edge);
  });
  if (border.size() == 0)
    return 0;
  EdgeSort images(job.scratch, job.options.memory_budget / 8);
  add_images(job, maps, original, shown, images);
  find_cracks(job, shown,
              fmt::format("random cut {} ({})", seed, counted(shown.cut.size(), "tiles")), border,
              images);
  return border.size();
}

}  // namespace

void verify_seams(const VerifyJob& job) {
  job.progress.stage("seams", std::uint64_t{job.options.cuts} + 1, "cuts");
  const Original original = look_at_original(job);
  job.progress.advance(1);
  ParentMaps maps = make_parent_maps(job);
  std::uint64_t most = 0;
  for (std::uint32_t i = 0; i < job.options.cuts; ++i) {
    most = std::max(most, look_at_cut(job, maps, original, job.options.seed + i));
    job.progress.advance(1);
  }
  job.checks.push_back(fmt::format("input surface: {} border edges, {} unbalanced edges{}",
                                   original.border_count, original.unbalanced.size(),
                                   original.unbalanced.size() == 0 ? ": closed and oriented" : ""));
  job.checks.push_back(fmt::format(
      "seams: {} from seed {}; at most {} in one, looked for in the input's borders",
      counted(job.options.cuts, "random cuts"), job.options.seed, counted(most, "border edges")));
}

}  // namespace meshhier::verifying
