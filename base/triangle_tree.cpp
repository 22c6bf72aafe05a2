#include "base/triangle_tree.h"

#include <limits>

namespace meshhier {

class TriangleTree::Builder {
 public:
  Builder(TriangleTree& tree, std::span<const SurfaceTriangle> triangles)
      : tree_(tree), triangles_(triangles) {
    items_.reserve(triangles.size());
    for (const auto& [a, b, c] : triangles)
      items_.push_back({a + b + c, static_cast<std::uint32_t>(items_.size())});
  }

  void operator()() {
    if (items_.empty())
      return;
    tree_.order_.reserve(items_.size());
    node(items_);
  }

 private:
  struct Item {
    Vec3f middle;  ///< three times that
    std::uint32_t triangle;
  };
  /// Nothing, until something is added: then no comparison of it is true.
  struct Box {
    static constexpr float kNever = std::numeric_limits<float>::infinity();
    std::array<float, 3> low{kNever, kNever, kNever}, high{-kNever, -kNever, -kNever};

    void add(const Vec3f& p) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        low[k] = std::min(low[k], p[axis]);
        high[k] = std::max(high[k], p[axis]);
      }
    }
    void add(const Box& box) {
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], box.low[k]);
        high[k] = std::max(high[k], box.high[k]);
      }
    }
    int longest_axis() const {
      const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
      return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    }
  };
  struct Child {
    std::uint32_t name = kNone;
    Box box;
  };

  Child node(std::span<Item> part) {
    const auto number = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_.emplace_back();
    std::array<Child, 4> children;
    std::size_t count = 0;
    for (const std::span<Item> half : halves(part)) {
      for (const std::span<Item> quarter : halves(half)) {
        if (!quarter.empty())
          children[count++] = quarter.size() <= tree_.leaf_size_ ? leaf(quarter) : node(quarter);
      }
    }
    Child result{number, {}};
    Node& node = tree_.nodes_[number];
    for (std::size_t k = 0; k < 4; ++k) {
      const Child& child = children[k];
      node.children[k] = child.name;
      node.low_x[k] = child.box.low[0], node.high_x[k] = child.box.high[0];
      node.low_y[k] = child.box.low[1], node.high_y[k] = child.box.high[1];
      node.low_z[k] = child.box.low[2], node.high_z[k] = child.box.high[2];
      result.box.add(child.box);
    }
    return result;
  }

  /// Sorts the lower half before the upper one, the lower of full leaves. A leaf is not halved.
  std::array<std::span<Item>, 2> halves(std::span<Item> part) const {
    const std::size_t size = tree_.leaf_size_;
    if (part.size() <= size)
      return {part, {}};
    Box middles;
    for (const Item& item : part)
      middles.add(item.middle);
    const int axis = middles.longest_axis();
    const std::size_t half = ((part.size() + size - 1) / size + 1) / 2 * size;
    std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(half), part.end(),
                     [&](const Item& a, const Item& b) {
                       const float at_a = a.middle[axis], at_b = b.middle[axis];
                       return at_a != at_b ? at_a < at_b : a.triangle < b.triangle;
                     });
    return {part.first(half), part.subspan(half)};
  }

  Child leaf(std::span<const Item> part) {
    const auto number = static_cast<std::uint32_t>(tree_.order_.size() / tree_.leaf_size_);
    Child result{number | kIsLeaf, {}};
    for (const Item& item : part) {
      tree_.order_.push_back(item.triangle);
      for (const Vec3f& corner : triangles_[item.triangle])
        result.box.add(corner);
    }
    return result;
  }

  TriangleTree& tree_;
  std::span<const SurfaceTriangle> triangles_;
  std::vector<Item> items_;
};

TriangleTree::TriangleTree(std::span<const SurfaceTriangle> triangles, std::size_t leaf_size)
    : leaf_size_(leaf_size) {
  Builder(*this, triangles)();
  nodes_.shrink_to_fit();  // else up to twice as many are held
}

}  // namespace meshhier
