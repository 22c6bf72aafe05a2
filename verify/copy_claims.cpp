#include "verify/copy_claims.h"

#include "export/tile_vertices.h"

#include <algorithm>
#include <array>
#include <bit>

namespace meshhier::verifying {
namespace {

std::uint16_t level_of(NodeId node) {
  return static_cast<std::uint16_t>(raw(node.level));
}

}  // namespace

/// Goes through the claims in order.
class CopyClaims::Judge {
 public:
  explicit Judge(const std::function<void(const WrongCopies&)>& visit) : visit_(visit) {}

  void hear(const Claim& claim) {
    if (!is_of_same(claim, last_))
      begin(claim);
    if (claim.by_neighbour == 0) {
      owned_.push_back(claim);
    } else {
      if (last_.by_neighbour == 0 || claim.tile != last_.tile)
        next_ = 0;
      judge(claim);
    }
    last_ = claim;
  }

  /// Tells of the owner whose claims have all been heard.
  void finish() {
    for (const auto& [tile, wrong] : wrong_)
      visit_(wrong);
    wrong_.clear();
  }

 private:
  static bool is_of_same(const Claim& a, const Claim& b) {
    return std::tuple(a.level, a.owner, a.place) == std::tuple(b.level, b.owner, b.place);
  }

  void begin(const Claim& claim) {
    if (claim.level != last_.level || claim.owner != last_.owner)
      finish();
    owned_.clear();
    next_ = 0;
  }

  void judge(const Claim& claim) {
    // The tile's claims must come in the owner's order, so the search goes on behind the last
    // match.
    const auto from = owned_.begin() + static_cast<std::ptrdiff_t>(next_);
    const auto found = std::find_if(from, owned_.end(),
                                    [&](const Claim& owned) { return owned.agrees_with(claim); });
    if (found != owned_.end()) {
      next_ = static_cast<std::size_t>(found - owned_.begin()) + 1;
      return;
    }
    next_ = owned_.size();  // later claims of the tile are wrong, too; so the time is linear
    const auto level = static_cast<Level>(claim.level);
    const WrongCopies first{{level, claim.tile}, {level, claim.owner}, 0, claim.place};
    ++wrong_.try_emplace(claim.tile, first).first->second.count;
  }

  const std::function<void(const WrongCopies&)>& visit_;
  Claim last_;
  std::vector<Claim> owned_;                    ///< claims of the owner about the place at hand
  std::size_t next_ = 0;                        ///< index in owned_ behind the tile's last claim
  std::map<std::uint32_t, WrongCopies> wrong_;  ///< wrong claims about one owner, by tile
};

void CopyClaims::add(const PublishedTile& tile) {
  add_own(tile, tile.node);
  if (tree_.stands_for_parent(tile.node))
    add_own(tile, tree_.parent(tile.node));
  add_ghosts(tile);
  add_splits(tile);
}

void CopyClaims::add_own(const PublishedTile& tile, NodeId node) {
  const TileMesh& mesh = tile.mesh;
  const std::size_t end = mesh.copies.first_of(mesh.boundary_count);
  for (std::size_t copy = 0; copy < end; ++copy) {
    Claim claim = claim_of(tile, node, copy);
    claim.place = mesh.copies.places[copy];
    claim.tile = node.index;
    claims_.add(claim);
  }
}

void CopyClaims::add_ghosts(const PublishedTile& tile) {
  const TileMesh& mesh = tile.mesh;
  for (std::size_t copy = exporting::own_copy_count(mesh); copy < mesh.copies.size(); ++copy) {
    const GhostRef& ghost = mesh.ghosts[mesh.copies.places[copy] - mesh.own_count];
    Claim claim = claim_of(tile, {tile.node.level, ghost.tile}, copy);
    claim.place = ghost.index;
    claim.by_neighbour = 1;
    claim.tile = tile.node.index;
    claims_.add(claim);
  }
}

void CopyClaims::add_splits(const PublishedTile& tile) {
  if (!tile.shading.texcoords.empty())
    return;  // splits differ from tile to tile then
  const TileMesh& mesh = tile.mesh;
  const VertexNumbers numbers = exporting::vertex_numbers(mesh);
  for (std::size_t split = 0; split < tile.shading.split_of.size(); ++split) {
    const std::uint32_t vertex = tile.shading.split_of[split];
    const std::uint32_t place = numbers[vertex].place;
    if (place >= mesh.boundary_count && place < mesh.own_count)
      continue;
    const bool own = place < mesh.own_count;
    const GhostRef owner =
        own ? GhostRef{tile.node.index, place} : mesh.ghosts[place - mesh.own_count];
    const NodeId node{tile.node.level, owner.tile};
    if (tree_.is_early(node))
      continue;  // its partition has normals of its own level
    if (has_texcoords_(node))
      continue;
    claims_.add(
        Claim{.level = level_of(node),
              .by_neighbour = std::uint16_t{!own},
              .owner = owner.tile,
              .place = owner.index,
              .tile = tile.node.index,
              .wedge = static_cast<std::uint32_t>(mesh.copies.size() + split),
              .normal = normal_bits(tile, mesh.vertices.size() + mesh.copies.size() + split),
              .vertex = split_hash(tile, vertex)});
  }
}

/// Returns a hash unlike that of any copy.
std::uint64_t CopyClaims::split_hash(const PublishedTile& tile, std::uint32_t vertex) {
  constexpr std::array<std::uint16_t, 1> kNoChain{};
  const TileMesh& mesh = tile.mesh;
  const std::size_t places = mesh.vertices.size();
  const exporting::VertexAt at = vertex < places
                                     ? exporting::VertexAt{mesh.vertices, vertex}
                                     : exporting::VertexAt{mesh.copies.vertices, vertex - places};
  return hash_(kNoChain, at, {}, true);
}

std::uint32_t CopyClaims::normal_bits(const PublishedTile& tile, std::size_t number) {
  const std::span<const NormalCode> normal = exporting::normal_of(tile.shading, number);
  return normal.empty() ? kAnyNormal : std::bit_cast<std::uint32_t>(normal.front());
}

/// A simplified tile may store attributes more coarsely than the partition beside it does, which
/// stands for an early node: then the position alone counts.
CopyClaims::Claim CopyClaims::claim_of(const PublishedTile& tile, NodeId owner, std::size_t copy) {
  Claim claim;
  claim.level = level_of(owner);
  claim.owner = owner.index;
  claim.wedge = static_cast<std::uint32_t>(copy);
  const bool with_attributes = !tree_.is_early(owner);
  if (with_attributes)
    claim.normal = normal_bits(tile, tile.mesh.vertices.size() + copy);
  claim.vertex = hash_({}, {tile.mesh.copies.vertices, copy}, {}, with_attributes);
  return claim;
}

void CopyClaims::finish(const std::function<void(const WrongCopies&)>& visit) {
  claims_.sort();
  Judge judge(visit);
  claims_.for_each_block([&](std::span<const Claim> claims) {
    for (const Claim& claim : claims)
      judge.hear(claim);
  });
  judge.finish();
}

}  // namespace meshhier::verifying
