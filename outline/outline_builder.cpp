#include "outline/outline_builder.h"

#include "outline/line_selection.h"
#include "outline/network.h"
#include "outline/tile_triangles.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>
#include <vector>

namespace meshhier::outline {

struct OutlineBuilder::Sector::Content : SectorContent {};

OutlineBuilder::Sector::Sector(std::uint32_t index, const TileMesh& tile, const Sectors& sectors)
    : content_(new Content) {
  const auto part = [&](std::uint32_t owner, std::uint32_t own) -> std::uint32_t {
    return sectors.empty() ? 0 : sectors.at(owner).at(own);
  };
  const auto corner = [&](std::uint32_t vertex) -> PlacedCorner {
    const TileVertex v{vertex};
    const std::uint32_t owner = tile.is_own(v) ? index : tile.ghost(v).tile;
    const std::uint32_t own = tile.is_own(v) ? vertex : tile.ghost(v).index;
    return {VertexKey{owner} << 32 | own, tile.vertices.positions[vertex], part(owner, own)};
  };
  content_->lines = lines_of(index, tile, [&](std::uint32_t a, std::uint32_t b) {
    return !in_one_sector(corner(a), corner(b));
  });
  for_each_triangle(tile, [&](const TileTriangle& t) {
    if (is_degenerate(t))
      return;
    PlacedTriangle triangle = {corner(raw(t[0])), corner(raw(t[1])), corner(raw(t[2]))};
    std::sort(triangle.begin(), triangle.end(),
              [](const PlacedCorner& a, const PlacedCorner& b) { return a.key < b.key; });
    // Every tile it touches has it; the lowest brings it.
    if (tile_of(triangle[0].key) == index && !touches_one(triangle))
      content_->triangles.push_back(triangle);
  });
  std::sort(content_->triangles.begin(), content_->triangles.end(), before);
}

OutlineBuilder::Sector::Sector(Sector&&) noexcept = default;
OutlineBuilder::Sector& OutlineBuilder::Sector::operator=(Sector&&) noexcept = default;
OutlineBuilder::Sector::~Sector() = default;

struct OutlineBuilder::Parts {
  std::vector<Sector::Content> sectors;
  std::vector<CrestLine> crests;
  std::size_t edge_count = 0;
  std::optional<Network> network;
};

OutlineBuilder::OutlineBuilder() : parts_(std::make_unique<Parts>()) {}
OutlineBuilder::OutlineBuilder(OutlineBuilder&&) noexcept = default;
OutlineBuilder& OutlineBuilder::operator=(OutlineBuilder&&) noexcept = default;
OutlineBuilder::~OutlineBuilder() = default;

void OutlineBuilder::add(Sector sector) {
  parts_->edge_count += sector.content_->triangles.size() + sector.content_->lines.borders.size() +
                        sector.content_->lines.creases.size();
  parts_->sectors.push_back(std::move(*sector.content_));
}

void OutlineBuilder::add(std::vector<CrestLine> crests) {
  parts_->crests = std::move(crests);
}

std::size_t OutlineBuilder::edge_count() const {
  return parts_->edge_count;
}

std::size_t OutlineBuilder::join() {
  std::vector<SectorContent*> sectors;
  for (SectorContent& sector : parts_->sectors)
    sectors.push_back(&sector);
  std::sort(sectors.begin(), sectors.end(),
            [](const auto* a, const auto* b) { return a->lines.tile < b->lines.tile; });
  return parts_->network.emplace(sectors).segment_count();
}

OutlineResult OutlineBuilder::finish(const OutlineOptions& options) {
  assert(parts_->network && options.tolerance > 0 && options.diagonal >= 0);
  Network& network = *parts_->network;
  network.make_segments();
  for (const CrestLine& crest : parts_->crests)
    network.add_form(crest.points);
  Lines lines(network, options.tolerance * options.diagonal, kShortestForm * options.diagonal);
  const Selection selection = select(lines, options);
  OutlineResult result;
  result.tolerance = selection.tolerance;
  result.polylines_found = lines.size();
  result.polylines_dropped = lines.size() - selection.chains.size();
  for (const std::uint32_t chain : selection.chains) {
    const bool is_form = lines.is_form(chain);
    const double tolerance = is_form ? options.tolerance : selection.tolerance;
    lines.append_to(result.outline, chain, tolerance * options.diagonal);
    result.outline.form_lines += is_form ? 1 : 0;
  }
  return result;
}

}  // namespace meshhier::outline
