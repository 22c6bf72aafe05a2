#include "cluster_simplify/seam_strip.h"

#include "base/error.h"
#include "cluster_simplify/cover_distance.h"
#include "cluster_simplify/nearest.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

namespace meshhier::cluster_simplify {

SeamStrip make_seam_strip(const BuildTile& joined, const ContractedTile& contracted) {
  constexpr std::uint32_t kUnset = std::numeric_limits<std::uint32_t>::max();
  const SimplifiedTile& tile = contracted.tile;
  const auto own_count = static_cast<std::uint32_t>(tile.vertices.size());
  SeamStrip seam_strip;
  seam_strip.boundary_count = tile.boundary_count;
  std::vector<std::uint32_t> place(own_count, kUnset);
  const auto add_own = [&](std::uint32_t v) {
    place[v] = seam_strip.own_count++;
    seam_strip.positions.push_back(tile.vertices.positions[v]);
    seam_strip.deviations.push_back(contracted.deviation.around[v]);
  };
  // The boundary keeps its numbers, which the neighbours know; other corners follow as they are
  // met.
  for (std::uint32_t v = 0; v < tile.boundary_count; ++v)
    add_own(v);
  for (const TileTriangle& t : tile.interior) {
    if (raw(t[0]) >= tile.boundary_count)  // the smallest corner
      break;                               // triangles ascend
    for (const TileVertex v : t) {
      if (place[raw(v)] == kUnset)
        add_own(raw(v));
    }
    seam_strip.interior.push_back(
        {TileVertex{place[raw(t[0])]}, TileVertex{place[raw(t[1])]}, TileVertex{place[raw(t[2])]}});
  }
  // Foreign corners lie where they were on the finer level: the contraction held them there.
  seam_strip.foreign = tile.foreign;
  const std::vector<GhostRef>& ghosts = joined.mesh.ghosts;
  for (const FinerGhost& corner : tile.foreign) {
    const auto found = std::lower_bound(ghosts.begin(), ghosts.end(), corner.ref);
    seam_strip.positions.push_back(
        joined.mesh.vertices
            .positions[joined.mesh.own_count + static_cast<std::size_t>(found - ghosts.begin())]);
  }
  for (const TileTriangle& t : tile.border) {
    TileTriangle& copy = seam_strip.border.emplace_back(t);
    for (TileVertex& v : copy)
      v = TileVertex{raw(v) < own_count ? place[raw(v)]
                                        : raw(v) - own_count + seam_strip.own_count};
  }
  seam_strip.interior_deviation = contracted.deviation.interior;
  seam_strip.lost = contracted.deviation.lost;
  seam_strip.mean_square = contracted.deviation.mean_square;
  return seam_strip;
}

namespace {

// No more triangles around a corner are asked about another: a vertex with thousands of them would
// take their number squared. Those at its neighbours are near enough.
constexpr std::uint32_t kMostAround = 64;

// No more triangles of the neighbours are held than of this tile, and these: of scans there are
// about three for four, but where all tiles are neighbours they would be all there are.
constexpr std::size_t kMostFurther = 4096;

enum class When : std::uint8_t {
  then,  ///< a border triangle as it was when its tile was made
  now,   ///< a border triangle as it is drawn
  both,  ///< an interior triangle
};

/// A triangle at the seam. It is small: around a vertex of a million triangles there are as many.
struct SeamTriangle {
  std::array<Vec3f, 3> positions;
  float deviation = 0;  ///< 0 if it is drawn now only
  When when = When::both;
  Triangle<std::uint32_t> vertices{};  ///< kNowhere: a vertex that nobody asks about

  CoverDistance::Corners corners() const {
    return {to_double(positions[0]), to_double(positions[1]), to_double(positions[2])};
  }
};

/// All triangles around one tile's seam, then and now. Its vertices are the own boundary, then the
/// ghosts.
class Seam {
 public:
  explicit Seam(const SeamInput& input)
      : input_(input), boundary_count_(input.mesh.boundary_count) {
    for (std::vector<std::uint32_t>& counts : counts_)
      counts.assign(boundary_count_ + ghosts().size(), 0);
    const SeamStrip& seam_strip = input.own.seam_strip;
    most_triangles_ =
        2 * (seam_strip.interior.size() + seam_strip.border.size() + input.mesh.border.size()) +
        kMostFurther;
    triangles_.reserve(most_triangles_);  // no second copy while it grows
    add_own();
    add_drawn();
    for (std::size_t i = 0; i < ghosts().size(); ++i) {
      if (i == 0 || ghosts()[i].tile != ghosts()[i - 1].tile)
        add({ghosts()[i].tile, input.seam_strip_of_neighbour(ghosts()[i].tile)});
    }
    link();
  }

  double gap() {
    double largest = 0;
    for (const SeamTriangle& t : triangles_) {
      if (!is_asked(t))
        continue;
      collect_covers(t);
      if (of_covers_.empty()) {
        lost_.push_back(&t);
        continue;
      }
      // Only the largest counts: what is below it, or below the tile's own, need not be exact.
      const double enough = std::max(largest, double{input_.own.seam_strip.interior_deviation});
      largest = std::max(largest, distance_to_covers(t, enough - t.deviation) + t.deviation);
    }
    return std::max(largest, farthest_lost());
  }

 private:
  using Vertices = Triangle<std::uint32_t>;

  struct Lists {
    std::vector<std::uint32_t> first, next;

    void add(std::uint32_t corner, std::uint32_t vertex) {
      next[corner] = first[vertex];
      first[vertex] = corner;
    }
  };

  static constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

  const std::vector<GhostRef>& ghosts() const { return input_.mesh.ghosts; }

  std::uint32_t vertex_of(const GhostRef& ref) const {
    const auto found = std::lower_bound(ghosts().begin(), ghosts().end(), ref);
    return found != ghosts().end() && *found == ref
               ? boundary_count_ + static_cast<std::uint32_t>(found - ghosts().begin())
               : kNowhere;
  }

  template <class VertexOf>
  static Vertices vertices_of(const TileTriangle& t, const VertexOf& vertex) {
    return {vertex(raw(t[0])), vertex(raw(t[1])), vertex(raw(t[2]))};
  }

  static bool any_known(const Vertices& vertices) {
    return vertices[0] != kNowhere || vertices[1] != kNowhere || vertices[2] != kNowhere;
  }

  static std::array<Vec3f, 3> positions_of(const TileTriangle& t,
                                           const std::vector<Vec3f>& positions) {
    return {positions[raw(t[0])], positions[raw(t[1])], positions[raw(t[2])]};
  }

  /// A bound of how far the triangle deviated: no more than all around any of its own corners.
  static float deviation_of(const SeamStrip& seam_strip, const TileTriangle& t) {
    float deviation = std::numeric_limits<float>::infinity();
    for (const TileVertex v : t) {
      if (raw(v) < seam_strip.own_count)
        deviation = std::min(deviation, seam_strip.deviations[raw(v)]);
    }
    return deviation;
  }

  /// Takes note of a triangle at its corners. False if each of them has had as many before it as
  /// are asked there.
  bool count(const Vertices& vertices, When when) {
    bool matters = false;
    for (const std::uint32_t v : vertices) {
      if (v == kNowhere)
        continue;
      if (when != When::now)
        matters = counts_[0][v]++ < kMostAround || matters;
      if (when != When::then)
        matters = counts_[1][v]++ < kMostAround || matters;
    }
    return matters;
  }

  /// `all`: also those that nobody will ask about others.
  template <class VertexOf>
  void add_seam_strip(const SeamStrip& seam_strip, bool all, const VertexOf& vertex) {
    const auto add = [&](const std::vector<TileTriangle>& triangles, When when) {
      for (const TileTriangle& t : triangles) {
        const Vertices vertices = vertices_of(t, vertex);
        if (!any_known(vertices))  // few of a neighbour's are
          continue;
        if ((count(vertices, when) && has_room()) || all)
          triangles_.push_back(
              {positions_of(t, seam_strip.positions), deviation_of(seam_strip, t), when, vertices});
      }
    };
    add(seam_strip.interior, When::both);
    add(seam_strip.border, When::then);
  }

  bool has_room() const { return triangles_.size() < most_triangles_; }

  void add_own() {
    const SeamStrip& seam_strip = input_.own.seam_strip;
    std::vector<std::uint32_t> foreign;
    foreign.reserve(input_.mapped.size());
    for (const GhostRef& ref : input_.mapped)
      foreign.push_back(vertex_of(ref));
    add_seam_strip(seam_strip, true, [&](std::uint32_t v) {
      return v < seam_strip.boundary_count ? v
             : v < seam_strip.own_count    ? kNowhere
                                           : foreign[v - seam_strip.own_count];
    });
    own_end_ = triangles_.size();
  }

  void add_drawn() {
    const TileMesh& mesh = input_.mesh;
    const auto vertex = [&](std::uint32_t v) {
      return v < mesh.own_count ? v : v - mesh.own_count + boundary_count_;
    };
    for (const TileTriangle& t : mesh.border) {
      triangles_.push_back(
          {positions_of(t, mesh.vertices.positions), 0, When::now, vertices_of(t, vertex)});
      count(triangles_.back().vertices, When::now);
    }
    drawn_end_ = triangles_.size();
  }

  void add(const SeamStripOf& neighbour) {
    std::vector<std::uint32_t> place(neighbour.seam_strip.boundary_count, kNowhere);
    auto ghost = std::lower_bound(ghosts().begin(), ghosts().end(), GhostRef{neighbour.tile, 0});
    for (; ghost != ghosts().end() && ghost->tile == neighbour.tile; ++ghost) {
      if (ghost->index >= place.size())
        throw Error(ErrorCode::internal, "a ghost lies outside its tile's boundary");
      place[ghost->index] = boundary_count_ + static_cast<std::uint32_t>(ghost - ghosts().begin());
    }
    add_seam_strip(neighbour.seam_strip, false,
                   [&](std::uint32_t v) { return v < place.size() ? place[v] : kNowhere; });
  }

  /// A list of corners 3 t + k per vertex and time.
  void link() {
    for (Lists& lists : at_) {
      lists.next.assign(triangles_.size() * 3, kNowhere);
      lists.first.assign(boundary_count_ + ghosts().size(), kNowhere);
    }
    for (std::size_t t = triangles_.size(); t-- > 0;) {
      for (std::size_t k = 3; k-- > 0;) {
        const std::uint32_t v = triangles_[t].vertices[k];
        if (v == kNowhere)
          continue;
        const auto corner = static_cast<std::uint32_t>(3 * t + k);
        if (triangles_[t].when != When::now)
          at_[0].add(corner, v);
        if (triangles_[t].when != When::then)
          at_[1].add(corner, v);
      }
    }
    met_.assign(triangles_.size(), {});
  }

  /// Border triangles: the own ones as they were, and those drawn now that no tile before this one
  /// asks about.
  bool is_asked(const SeamTriangle& t) const {
    const auto index = static_cast<std::size_t>(&t - triangles_.data());
    if (index >= drawn_end_ || t.when == When::both)
      return false;
    return index < own_end_ ||
           std::all_of(t.vertices.begin(), t.vertices.end(), [&](std::uint32_t v) {
             return v < boundary_count_ || ghosts()[v - boundary_count_].tile > input_.own.tile;
           });
  }

  /// Collects the triangles around the triangle's corners at the other time. Those that share more
  /// than one corner with it come first: they are mostly near enough.
  void collect_covers(const SeamTriangle& t) {
    of_covers_.clear();
    front_ = 0;
    const auto mark = static_cast<std::uint32_t>(&t - triangles_.data());
    const Lists& lists = at_[t.when == When::then ? 1 : 0];
    for (const std::uint32_t v : t.vertices) {
      if (v == kNowhere)
        continue;
      std::uint32_t seen = 0;
      for (std::uint32_t i = lists.first[v]; i != kNowhere && seen < kMostAround;
           i = lists.next[i], ++seen)
        add_cover(i / 3, mark);
    }
  }

  void add_cover(std::uint32_t index, std::uint32_t mark) {
    if (met_[index].by == mark) {
      if (met_[index].place >= front_)
        move_to_front(index);
      return;
    }
    met_[index] = {mark, static_cast<std::uint32_t>(of_covers_.size())};
    of_covers_.push_back(index);
  }

  void move_to_front(std::uint32_t index) {
    const std::uint32_t from = met_[index].place;
    std::swap(of_covers_[from], of_covers_[front_]);
    met_[of_covers_[from]].place = from;
    met_[of_covers_[front_]].place = front_;
    ++front_;
  }

  Cover cover(const SeamTriangle& t, std::uint32_t index) const {
    const SeamTriangle& other = triangles_[index];
    const CoverDistance::Corners corners = other.corners();
    return {{corners[0], corners[1], corners[2]},
            t.when == When::now ? double{other.deviation} : 0};
  }

  /// From the triangle to the covers just collected; see CoverDistance.
  double distance_to_covers(const SeamTriangle& t, double enough) {
    constexpr std::size_t kTried = 3;  // one of them is mostly near enough
    const CoverDistance::Corners corners = t.corners();
    covers_.clear();
    for (const std::uint32_t index : of_covers_) {
      covers_.push_back(cover(t, index));
      if (covers_.size() > kTried)
        continue;
      const double distance = CoverDistance::near_one(corners, covers_.back(), enough);
      if (distance >= 0)
        return distance;
    }
    return cover_distance_(corners, covers_, enough);
  }

  /// The largest distance of border triangles around whose corners nothing is left from the nearest
  /// vertex that is drawn.
  double farthest_lost() const {
    if (lost_.empty())
      return 0;
    std::vector<std::uint32_t> drawn;
    for (const auto* triangles : {&input_.mesh.interior, &input_.mesh.border}) {
      for (const TileTriangle& t : *triangles)
        drawn.insert(drawn.end(), {raw(t[0]), raw(t[1]), raw(t[2])});
    }
    std::sort(drawn.begin(), drawn.end());
    drawn.erase(std::unique(drawn.begin(), drawn.end()), drawn.end());
    const std::vector<Vec3f>& positions = input_.mesh.vertices.positions;
    const NearestDrawn nearest(positions, drawn);
    double farthest = 0;
    for (const SeamTriangle* t : lost_) {
      const double away = nearest.from(t->positions[0], [&](std::uint32_t drawn_vertex) {
        double most = 0;
        for (const Vec3d& corner : t->corners())
          most = std::max(most, length(corner - to_double(positions[drawn_vertex])));
        return most;
      });
      farthest = std::max(farthest, away + t->deviation);
    }
    return farthest * (1 + 0x1p-40);
  }

  const SeamInput& input_;
  std::uint32_t boundary_count_;
  std::size_t most_triangles_ = 0;
  std::vector<SeamTriangle> triangles_;
  std::array<std::vector<std::uint32_t>, 2> counts_;  ///< of those lists, and what was left out
  std::size_t own_end_ = 0;                           ///< the own seam strip's come first,
  std::size_t drawn_end_ = 0;  ///< then what is drawn now, then the neighbours' seam strips
  std::array<Lists, 2> at_;    ///< then, now
  struct Met {
    std::uint32_t by = kNowhere;  ///< the last triangle it may cover
    std::uint32_t place = 0;      ///< among that one's covers
  };
  std::vector<Met> met_;  ///< per triangle
  // Around one triangle:
  std::vector<std::uint32_t> of_covers_;  ///< the triangles that may cover it
  std::uint32_t front_ = 0;               ///< so many of them share more than one corner with it
  std::vector<Cover> covers_;
  CoverDistance cover_distance_;
  std::vector<const SeamTriangle*> lost_;
};

}  // namespace

double seam_gap(const SeamInput& input) {
  return input.mesh.border.empty() && input.own.seam_strip.border.empty() ? 0 : Seam(input).gap();
}

}  // namespace meshhier::cluster_simplify
