#include "hierarchy/tile_mesh.h"

#include "base/sort_few.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace meshhier {

void VertexArray::reserve(std::size_t count) {
  positions.reserve(count);
  attributes.reserve(count * static_cast<std::size_t>(channels));
}

void VertexArray::append(Vec3f position, std::span<const float> vertex_attributes) {
  positions.push_back(position);
  attributes.insert(attributes.end(), vertex_attributes.begin(), vertex_attributes.end());
}

void VertexArray::append(const VertexArray& other, std::size_t begin, std::size_t end) {
  const auto offset = [&](std::size_t vertex) {
    return other.attributes.begin() +
           static_cast<std::ptrdiff_t>(vertex * static_cast<std::size_t>(channels));
  };
  positions.insert(positions.end(), other.positions.begin() + static_cast<std::ptrdiff_t>(begin),
                   other.positions.begin() + static_cast<std::ptrdiff_t>(end));
  attributes.insert(attributes.end(), offset(begin), offset(end));
}

void VertexArray::append(const VertexArray& other, std::span<const std::uint32_t> vertices) {
  const std::size_t first = size();
  positions.resize(first + vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    positions[first + i] = other.positions[vertices[i]];
  if (channels == 0)
    return;
  const auto width = static_cast<std::size_t>(channels);
  attributes.resize(positions.size() * width);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    std::ranges::copy(other.attributes_of(vertices[i]),
                      attributes.begin() + static_cast<std::ptrdiff_t>((first + i) * width));
}

void VertexArray::keep_channels(int count) {
  if (count == channels)
    return;
  const auto from = static_cast<std::size_t>(channels);
  const auto to = static_cast<std::size_t>(count);
  for (std::size_t i = 0; i < size(); ++i)
    std::copy_n(attributes.begin() + static_cast<std::ptrdiff_t>(i * from), to,
                attributes.begin() + static_cast<std::ptrdiff_t>(i * to));
  attributes.resize(size() * to);
  channels = count;
}

Copies sorted_by_place(const Copies& copies) {
  std::vector<std::uint32_t> order(copies.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return copies.places[a] < copies.places[b];
  });
  Copies sorted;
  sorted.vertices.channels = copies.vertices.channels;
  sorted.vertices.append(copies.vertices, order);
  sorted.places.reserve(order.size());
  for (const std::uint32_t copy : order)
    sorted.places.push_back(copies.places[copy]);
  return sorted;
}

Copies renumbered(Copies copies, std::span<const std::uint32_t> place) {
  for (std::uint32_t& at : copies.places)
    at = place[at];
  return sorted_by_place(copies);
}

namespace {

/// By a counting sort on the first corner; a handful share it, so the rest is a sort of tiny
/// groups, by sort_group(). Four times faster than one comparison sort at 16 k triangles.
template <class Item, class FirstCorner, class SortGroup>
void sort_by_first_corner(std::vector<Item>& items, FirstCorner first_corner,
                          SortGroup sort_group) {
  std::uint32_t corner_count = 0;
  for (const Item& item : items)
    corner_count = std::max(corner_count, first_corner(item) + 1);
  // Where the group of corner c begins is at [c + 1] until the triangles are put, its end
  // afterwards.
  std::vector<std::uint32_t> ends(std::size_t{corner_count} + 2);
  for (const Item& item : items)
    ++ends[first_corner(item) + 2];
  for (std::size_t i = 2; i < ends.size(); ++i)
    ends[i] += ends[i - 1];
  std::vector<Item> sorted(items.size());
  for (const Item& item : items)
    sorted[ends[first_corner(item) + 1]++] = item;
  for (std::size_t i = 0; i < corner_count; ++i)
    sort_group(std::span(sorted).subspan(ends[i], ends[i + 1] - ends[i]));
  items = std::move(sorted);
}

/// Sorts canonical triangles.
void sort(std::vector<TileTriangle>& triangles) {
  const auto rest = [](const TileTriangle& t) {
    return std::uint64_t{raw(t[1])} << 32 | raw(t[2]);
  };
  sort_by_first_corner(
      triangles, [](const TileTriangle& t) { return raw(t[0]); },
      [&](std::span<TileTriangle> group) { sort_few(group, rest); });
}

}  // namespace

void normalize_triangles(std::vector<TileTriangle>& triangles, bool unique) {
  std::size_t count = 0;
  for (const TileTriangle& t : triangles) {
    const bool stays = !is_degenerate(t);
    triangles[count] = canonical(t);
    count += std::size_t{stays};
  }
  triangles.resize(count);
  sort(triangles);
  if (unique)
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
}

namespace {

struct Wedged {
  TileTriangle places;
  CornerWedges wedges;
};

void sort(std::vector<Wedged>& triangles) {
  sort_by_first_corner(
      triangles, [](const Wedged& t) { return raw(t.places[0]); },
      [](std::span<Wedged> group) {
        sort_few(group, [](const Wedged& t) {
          return std::pair(std::uint64_t{raw(t.places[1])} << 32 | raw(t.places[2]), t.wedges);
        });
      });
}

/// The smallest corner by place and wedge.
std::size_t smallest_wedge(const Wedged& t) {
  if (!is_degenerate(t.places))
    return smallest_corner(t.places);
  const auto corner = [&](std::size_t k) { return std::pair(t.places[k], t.wedges[k]); };
  return corner(1) < std::min(corner(0), corner(2))   ? 1
         : corner(2) < std::min(corner(0), corner(1)) ? 2
                                                      : 0;
}

/// Whether two corners are equal; by their places alone if `unique`.
bool is_degenerate(const Wedged& t, bool unique) {
  return is_degenerate(t.places) &&
         (unique || (t.places[0] == t.places[1] && t.wedges[0] == t.wedges[1]) ||
          (t.places[1] == t.places[2] && t.wedges[1] == t.wedges[2]) ||
          (t.places[2] == t.places[0] && t.wedges[2] == t.wedges[0]));
}

}  // namespace

void normalize_triangles(std::vector<TileTriangle>& triangles, std::vector<CornerWedges>& wedges,
                         bool unique) {
  if (wedges.empty())
    return normalize_triangles(triangles, unique);
  std::vector<Wedged> sorted(triangles.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Wedged t{triangles[i], wedges[i]};
    const std::size_t first = smallest_wedge(t);
    sorted[count] = {turned(t.places, first), turned(t.wedges, first)};
    count += std::size_t{!is_degenerate(t, unique)};
  }
  sorted.resize(count);
  sort(sorted);
  if (unique) {
    sorted.erase(std::unique(sorted.begin(), sorted.end(),
                             [](const Wedged& a, const Wedged& b) { return a.places == b.places; }),
                 sorted.end());
  }
  triangles.resize(sorted.size());
  wedges.resize(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    triangles[i] = sorted[i].places;
    wedges[i] = sorted[i].wedges;
  }
}

}  // namespace meshhier
