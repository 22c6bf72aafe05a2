#include "texture/leaf_atlas.h"

#include "texture/rect_packing.h"
#include "texture/shared_texels.h"
#include "texture/texel_charts.h"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace meshhier::texture {
namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// A rectangle of the atlas before it has its place.
struct Cell {
  TexelBox texels;
  std::uint32_t level = 0;
  bool is_flat = false;  ///< a single colour: the corners are at its middle
};

class Planner {
 public:
  Planner(const LeafTriangles& leaf, std::span<const AtlasMaterial> materials,
          std::uint32_t most_side)
      : leaf_(leaf),
        materials_(materials),
        most_side_(most_side),
        charts_(cut_charts(leaf, materials, most_side)),
        texels_(share_texels(charts_.pieces, materials, most_side)) {}

  LeafAtlas operator()() && {
    LeafAtlas atlas;
    atlas.corners.resize(leaf_.triangles.size());
    for (std::uint32_t c = 0; c < texels_.shared.size(); ++c) {
      cells_.push_back(cell(c, 0));
      while (!cells_[c].is_flat && larger_side(cells_[c]) > most_side_)
        coarsen(c);
    }
    if (!cells_.empty())
      place(atlas, pack());
    return atlas;
  }

 private:
  static std::int64_t larger_side(const Cell& cell) {
    return std::max(cell.texels.width, cell.texels.height);
  }
  std::uint32_t material_of(std::uint32_t cell) const { return texels_.shared[cell].material; }
  const AtlasMaterial& picture_of(std::uint32_t cell) const {
    return materials_[material_of(cell)];
  }

  /// The texels that charts share, in a level of their picture. They are flat where it has one
  /// texel, or does not exist.
  Cell cell(std::uint32_t number, std::uint32_t level) const {
    const AtlasMaterial& picture = picture_of(number);
    const bool is_flat =
        picture.width == 0 || level >= picture.levels ||
        std::max(level_side(picture.width, level), level_side(picture.height, level)) <= 1;
    if (!is_flat)
      return {texels_around(texels_.shared[number].box, picture, level), level, false};
    const std::uint32_t last = std::max(picture.levels, 1U) - 1;
    return {{0, 0, kLeafAlignment, kLeafAlignment}, std::min(level, last), true};
  }
  void coarsen(std::uint32_t number) { cells_[number] = cell(number, cells_[number].level + 1); }

  /// Cells that need a place of their own: of a material's flat ones only the first does.
  std::vector<std::uint32_t> distinct_cells() const {
    std::vector<bool> has_flat(materials_.size());
    std::vector<std::uint32_t> distinct;
    for (std::uint32_t c = 0; c < cells_.size(); ++c) {
      const std::uint32_t material = material_of(c);
      if (cells_[c].is_flat && has_flat[material])
        continue;
      has_flat[material] = has_flat[material] || cells_[c].is_flat;
      distinct.push_back(c);
    }
    return distinct;
  }

  double texels_of(const std::vector<std::uint32_t>& cells) const {
    double texels = 0;
    for (const std::uint32_t c : cells)
      texels += cells_[c].texels.area();
    return texels;
  }

  /// Takes the largest cells down a level, one by one, until they have no more texels than this.
  /// False if all are flat already.
  bool shrink(double most_texels) {
    const auto is_smaller = [&](std::uint32_t a, std::uint32_t b) {
      const double area_a = cells_[a].texels.area(), area_b = cells_[b].texels.area();
      return area_a != area_b ? area_a < area_b : a > b;
    };
    std::vector<std::uint32_t> heap;
    for (std::uint32_t c = 0; c < cells_.size(); ++c) {
      if (!cells_[c].is_flat)
        heap.push_back(c);
    }
    if (heap.empty())
      return false;
    std::make_heap(heap.begin(), heap.end(), is_smaller);
    double texels = texels_of(distinct_cells());
    while (!heap.empty() && texels > most_texels) {
      std::pop_heap(heap.begin(), heap.end(), is_smaller);
      const std::uint32_t largest = heap.back();
      texels -= cells_[largest].texels.area();
      coarsen(largest);
      texels += cells_[largest].is_flat ? 0 : cells_[largest].texels.area();
      if (cells_[largest].is_flat)
        heap.pop_back();
      else
        std::push_heap(heap.begin(), heap.end(), is_smaller);
    }
    return true;
  }

  /// Packs the distinct cells, in units of the alignment.
  std::optional<RectPacking> try_pack(std::uint32_t most_side) const {
    std::vector<RectSize> sizes;
    for (const std::uint32_t c : distinct_cells())
      sizes.push_back({static_cast<std::uint32_t>(cells_[c].texels.width / kLeafAlignment),
                       static_cast<std::uint32_t>(cells_[c].texels.height / kLeafAlignment)});
    return pack_tightly(sizes, most_side / kLeafAlignment);
  }

  /// Each time that there is no room, the cells get a bit smaller.
  RectPacking pack() {
    constexpr double kLess = 0.95;
    double most_texels = double(most_side_) * most_side_;
    for (;;) {
      const double texels = texels_of(distinct_cells());
      if (texels <= most_texels) {
        if (std::optional<RectPacking> packing = try_pack(most_side_))
          return *std::move(packing);
        most_texels = std::min(most_texels, texels) * kLess;
      }
      if (!shrink(most_texels))
        return *try_pack(kMaxImageSide * kLeafAlignment);
    }
  }

  void place(LeafAtlas& atlas, const RectPacking& packing) {
    atlas.width = packing.width * kLeafAlignment;
    atlas.height = packing.height * kLeafAlignment;
    atlas.charts = charts_.pieces.size();
    std::vector<std::uint32_t> piece_of(cells_.size(), kNone);
    std::vector<std::uint32_t> flat_piece(materials_.size(), kNone);
    for (const std::uint32_t c : distinct_cells()) {
      const auto piece = static_cast<std::uint32_t>(atlas.pieces.size());
      const RectPlace& at = packing.places[piece];
      atlas.pieces.push_back(piece_at(c, at));
      piece_of[c] = piece;
      if (cells_[c].is_flat)
        flat_piece[material_of(c)] = piece;
    }
    for (std::uint32_t c = 0; c < cells_.size(); ++c) {
      if (cells_[c].is_flat)
        piece_of[c] = flat_piece[material_of(c)];
    }
    for (std::uint32_t chart = 0; chart < charts_.pieces.size(); ++chart)
      give_corners(atlas, chart, atlas.pieces[piece_of[texels_.places[chart].shared]]);
  }

  AtlasPiece piece_at(std::uint32_t number, const RectPlace& at) const {
    const Cell& cell = cells_[number];
    return {material_of(number),
            cell.level,
            cell.texels.x,
            cell.texels.y,
            at.x * kLeafAlignment,
            at.y * kLeafAlignment,
            static_cast<std::uint32_t>(cell.texels.width),
            static_cast<std::uint32_t>(cell.texels.height)};
  }

  void give_corners(LeafAtlas& atlas, std::uint32_t chart, const AtlasPiece& piece) {
    const ChartPiece& part = charts_.pieces[chart];
    const SharedPlace& place = texels_.places[chart];
    for (std::uint32_t i = part.begin; i < part.end; ++i) {
      const std::uint32_t t = charts_.triangles[i];
      for (std::size_t k = 0; k < 3; ++k)
        atlas.corners[t][k] = corner(atlas, place, piece, raw(leaf_.triangles[t][k]));
    }
    if (cells_[place.shared].level > 0)
      atlas.reduced += part.end - part.begin;
  }

  Vec2f corner(const LeafAtlas& atlas, const SharedPlace& place, const AtlasPiece& piece,
               std::uint32_t vertex) const {
    const AtlasMaterial& picture = picture_of(place.shared);
    const auto in_atlas = [&](double at, std::uint32_t side, std::int64_t from, std::uint32_t to,
                              std::uint32_t atlas_side) {
      const double inside = cells_[place.shared].is_flat
                                ? kLeafAlignment / 2.0
                                : at * level_side(side, piece.level) - static_cast<double>(from);
      return static_cast<float>((inside + to) / atlas_side);
    };
    const Vec2f& at = leaf_.texcoords[vertex];
    return {in_atlas(clamped_texcoord(at.u) + place.u, picture.width, piece.x, piece.atlas_x,
                     atlas.width),
            in_atlas(clamped_texcoord(at.v) + place.v, picture.height, piece.y, piece.atlas_y,
                     atlas.height)};
  }

  const LeafTriangles& leaf_;
  std::span<const AtlasMaterial> materials_;
  std::uint32_t most_side_;
  ChartPieces charts_;
  SharedCharts texels_;
  std::vector<Cell> cells_;  ///< of all that charts share
};

}  // namespace

LeafAtlas plan_leaf_atlas(const LeafTriangles& leaf, std::span<const AtlasMaterial> materials,
                          std::uint32_t most_side) {
  return Planner(leaf, materials, most_side)();
}

}  // namespace meshhier::texture
