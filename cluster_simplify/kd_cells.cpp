#include "cluster_simplify/kd_cells.h"

#include "base/bounds.h"

#include <algorithm>

namespace meshhier::cluster_simplify {
namespace {

struct Point {
  Vec3f position;
  std::uint32_t index;
};

struct Cells {
  std::uint32_t begin, end;
};

int longest_axis(std::span<const Point> points) {
  Bounds bounds;
  for (const Point& p : points)
    bounds.add(p.position);
  const Vec3f size = bounds.max - bounds.min;
  if (size.x >= size.y && size.x >= size.z)
    return 0;
  return size.y >= size.z ? 1 : 2;
}

class Splitter {
 public:
  Splitter(std::span<const Vec3f> positions, std::uint32_t cell_count)
      : cell_count_(cell_count), points_(positions.size()), cell_of_(positions.size()) {
    for (std::uint32_t i = 0; i < positions.size(); ++i)
      points_[i] = {positions[i], i};
  }

  std::vector<std::uint32_t> run() {
    split({0, cell_count_});
    return std::move(cell_of_);
  }

 private:
  std::size_t first_point(std::uint32_t cell) const {
    return std::uint64_t{cell} * points_.size() / cell_count_;
  }

  void split(Cells cells) {
    const std::span<Point> all(points_);
    const std::size_t begin = first_point(cells.begin);
    const std::size_t end = first_point(cells.end);
    if (cells.end - cells.begin == 1) {
      for (const Point& p : all.subspan(begin, end - begin))
        cell_of_[p.index] = cells.begin;
      return;
    }
    const std::uint32_t middle_cell = cells.begin + (cells.end - cells.begin + 1) / 2;
    const std::size_t middle = first_point(middle_cell);
    const int axis = longest_axis(all.subspan(begin, end - begin));
    const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [axis](const Point& a, const Point& b) {
      const float x = a.position[axis];
      const float y = b.position[axis];
      return x < y || (x == y && a.index < b.index);
    });
    split({cells.begin, middle_cell});
    split({middle_cell, cells.end});
  }

  std::uint32_t cell_count_;
  std::vector<Point> points_;
  std::vector<std::uint32_t> cell_of_;
};

}  // namespace

std::vector<std::uint32_t> kd_cells(std::span<const Vec3f> points, std::uint32_t cell_count) {
  return Splitter(points, cell_count).run();
}

}  // namespace meshhier::cluster_simplify
