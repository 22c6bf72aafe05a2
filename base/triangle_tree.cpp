#include "base/triangle_tree.h"

#include <bit>
#include <limits>

namespace meshhier {

class TriangleTree::Builder {
 public:
  Builder(TriangleTree& tree, std::span<const SurfaceTriangle> triangles)
      : tree_(tree), triangles_(triangles) {
    items_.reserve(triangles.size());
    for (const auto& [a, b, c] : triangles) {
      const Vec3f sum = a + b + c;
      items_.push_back({{in_order(sum.x), in_order(sum.y), in_order(sum.z)},
                        static_cast<std::uint32_t>(items_.size())});
    }
  }

  void operator()() {
    if (items_.empty())
      return;
    tree_.order_.reserve(items_.size());
    node(items_);
  }

 private:
  /// Returns a number that is less where the float is: integers are compared without a branch.
  static std::int32_t in_order(float x) { return turned(std::bit_cast<std::int32_t>(x + 0.0F)); }
  static float from_order(std::int32_t x) { return std::bit_cast<float>(turned(x)); }
  static std::int32_t turned(std::int32_t x) { return x ^ ((x >> 31) & 0x7fffffff); }

  /// 16 bytes, as four lanes have.
  struct Item {
    std::array<std::int32_t, 3> middle;  ///< three times that, in_order()
    std::uint32_t triangle;

    /// Items are sorted by it. All differ.
    std::int64_t key(std::size_t axis) const { return std::int64_t{middle[axis]} << 32 | triangle; }
  };
  /// Nothing, until something is added: then no comparison of it is true. The last lane is unused.
  struct Box {
    static constexpr float kNever = std::numeric_limits<float>::infinity();
    Four low = Four{} + kNever, high = Four{} - kNever;

    void add(const Vec3f& p) { add({Four{p.x, p.y, p.z, 0}, Four{p.x, p.y, p.z, 0}}); }
    void add(const Box& box) {
      low = box.low < low ? box.low : low;
      high = box.high > high ? box.high : high;
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
    const auto add = [&](std::span<Item> quarter) {
      if (!quarter.empty())
        children[count++] = quarter.size() <= tree_.leaf_size_ ? leaf(quarter) : node(quarter);
    };
    if (tree_.leaf_size_ == 1 && part.size() <= children.size()) {
      for (std::size_t i = 0; i < part.size(); ++i)
        add(part.subspan(i, 1));
    } else {
      for (const std::span<Item> half : halves(part))
        std::ranges::for_each(halves(half), add);
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
    const std::size_t half = ((part.size() + size - 1) / size + 1) / 2 * size;
    if (half < part.size())
      select(part, half, longest_axis(part));
    return {part.first(half), part.subspan(half)};
  }

  static std::size_t longest_axis(std::span<const Item> part) {
    auto low = load_four<FourInts>(part.data()), high = low;
    for (const Item& item : part) {
      const auto middle = load_four<FourInts>(&item);
      low = middle < low ? middle : low;
      high = middle > high ? middle : high;
    }
    const auto size = [&](int axis) { return from_order(high[axis]) - from_order(low[axis]); };
    const float x = size(0), y = size(1), z = size(2);
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  }

  /// Moves the `count` lowest items to the front, as std::nth_element() does, which takes twice as
  /// long: half of its branches are guessed wrong. Requires count < part.size().
  static void select(std::span<Item> part, std::size_t count, std::size_t axis) {
    const auto by_key = [axis](const Item& a, const Item& b) { return a.key(axis) < b.key(axis); };
    // Halving takes some six rounds to a few items, for which a sort is quicker.
    constexpr std::size_t kFew = 12;
    constexpr int kMostRounds = 20;
    for (int round = 0; round < kMostRounds && part.size() > kFew; ++round) {
      const std::int64_t pivot = likely_key(part, count, axis);
      std::size_t lower = 0;
      for (Item& item : part) {
        const Item here = item;
        item = part[lower];
        part[lower] = here;
        lower += here.key(axis) < pivot ? 1 : 0;
      }
      if (count < lower) {
        part = part.first(lower);
      } else {
        part = part.subspan(lower);
        count -= lower;
      }
    }
    std::sort(part.begin(), part.end(), by_key);
  }
  /// Returns the key of an item that about `count` others are below.
  static std::int64_t likely_key(std::span<const Item> part, std::size_t count, std::size_t axis) {
    std::array<std::int64_t, 5> some{};
    for (std::size_t i = 0; i < some.size(); ++i)
      some[i] = part[(2 * i + 1) * part.size() / (2 * some.size())].key(axis);
    std::ranges::sort(some);
    return some[count * some.size() / part.size()];
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
