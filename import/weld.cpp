#include "import/weld.h"

#include "base/error.h"
#include "execution/spool_cursor.h"
#include "import/renumber_triangles.h"
#include "partition/external_sort.h"

#include <bit>
#include <optional>

namespace meshhier::importing {
namespace {

/// An item: the bits of what it holds, and which one it is.
template <std::size_t Words>
struct Item {
  std::array<std::uint32_t, Words> bits{};
  std::array<std::uint8_t, 8>
      number{};  ///< highest byte first: of equal bits the first item is least

  std::uint64_t index() const {
    std::uint64_t index = 0;
    for (const std::uint8_t byte : number)
      index = index << 8 | byte;
    return index;
  }
  void set_index(std::uint64_t index) {
    for (std::size_t i = number.size(); i-- > 0; index >>= 8)
      number[i] = static_cast<std::uint8_t>(index);
  }
};

/// One number to compare instead of many; of equal numbers the items' bytes decide.
struct ItemKey {
  template <std::size_t Words>
  std::uint64_t operator()(const Item<Words>& item) const {
    std::uint64_t key = 0;
    for (const std::uint32_t word : item.bits)
      key = (key + word) * 0x9E3779B97F4A7C15;  // 2^64 over the golden ratio
    return key;
  }
};

/// Sorted by the first of the two.
struct Pair {
  std::uint64_t first;
  std::uint64_t second;
};
struct PairKey {
  std::uint64_t operator()(const Pair& pair) const { return pair.first; }
};
using PairSort = partition::ExternalSort<Pair, PairKey>;

/// Collects the words of an item; numbers that are equal have equal bits.
template <std::size_t Words>
class ItemBits {
 public:
  void add(float value) { bits_[used_++] = std::bit_cast<std::uint32_t>(value + 0.0F); }
  void add(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);
    bits_[used_++] = static_cast<std::uint32_t>(bits >> 32);
    bits_[used_++] = static_cast<std::uint32_t>(bits);
  }
  const std::array<std::uint32_t, Words>& all() const { return bits_; }

 private:
  std::array<std::uint32_t, Words> bits_{};
  std::size_t used_ = 0;
};

/// Finds equal items. Calls keep(index) for each that stays, ascending, then take(number) for all
/// items in their order: the number of the one that stands for it. `bits_of(index, bits)` is called
/// for all, ascending. Returns how many stay.
template <std::size_t Words, class BitsOf, class Keep, class Take>
std::uint64_t number_equals(std::uint64_t count, const BitsOf& bits_of, const Keep& keep,
                            const Take& take, const ImportRoom& room) {
  PairSort by_first(room.scratch, room.sort_bytes);
  {
    // By bits: equal items come together. The number is the last part of an item, so the first of
    // them comes first.
    partition::ExternalSort<Item<Words>, ItemKey> by_bits(room.scratch, room.sort_bytes);
    for (std::uint64_t i = 0; i < count; ++i) {
      ItemBits<Words> bits;
      bits_of(i, bits);
      Item<Words> item{bits.all()};
      item.set_index(i);
      by_bits.add(item);
    }
    by_bits.sort();
    Item<Words> first;
    bool is_begun = false;
    by_bits.for_each_block([&](std::span<const Item<Words>> block) {
      room.cancel.check();
      for (const Item<Words>& item : block) {
        if (!is_begun || item.bits != first.bits)
          first = item;
        is_begun = true;
        by_first.add({first.index(), item.index()});
      }
    });
  }
  // By the first of equal ones: those that stay come in the order in which they first appear.
  by_first.sort();
  std::uint64_t kept = 0;
  std::uint64_t last = UINT64_MAX;  // first of those before
  PairSort by_item(room.scratch, room.sort_bytes);
  by_first.for_each_block([&](std::span<const Pair> block) {
    room.cancel.check();
    for (const auto& [first, item] : block) {
      if (first != last) {
        keep(first);
        ++kept;
        last = first;
      }
      by_item.add({item, kept - 1});
    }
  });
  // By item: numbers come in the order of the caller's items.
  by_item.sort();
  by_item.for_each_block([&](std::span<const Pair> block) {
    room.cancel.check();
    for (const Pair& pair : block)
      take(pair.second);
  });
  return kept;
}

/// A vertex's number below 2^32.
std::uint32_t checked_number(std::uint64_t number) {
  if (number >= UINT32_MAX)
    throw Error(ErrorCode::input, "the input has 2^32 vertices or more; split it");
  return static_cast<std::uint32_t>(number);
}

/// Fills the table from the old numbers of vertices to the new ones, and the vertices of `welded`.
template <std::size_t Words>
std::uint64_t weld_into(const RawMesh& mesh, RawMesh& welded,
                        storage::RecordSpool<std::uint32_t>& table, const ImportRoom& room) {
  const std::size_t channels = mesh.channels();
  execution::SpoolCursor positions(mesh.positions, room.cancel),
      kept_positions(mesh.positions, room.cancel);
  execution::SpoolCursor attributes(mesh.attributes, room.cancel),
      kept_attributes(mesh.attributes, room.cancel);
  const auto bits_of = [&](std::uint64_t i, ItemBits<Words>& bits) {
    const Vec3d p = positions.at(i);
    for (int axis = 0; axis < 3; ++axis)
      mesh.fits_float ? bits.add(static_cast<float>(p[axis])) : bits.add(p[axis]);
    for (std::size_t c = 0; c < channels; ++c)
      bits.add(attributes.at(i * channels + c));
  };
  const auto keep = [&](std::uint64_t i) {
    welded.positions.append(kept_positions.at(i));
    for (std::size_t c = 0; c < channels; ++c)
      welded.attributes.append(kept_attributes.at(i * channels + c));
  };
  return number_equals<Words>(
      mesh.vertex_count(), bits_of, keep,
      [&](std::uint64_t number) { table.append(checked_number(number)); }, room);
}

std::uint64_t weld_into(const RawMesh& mesh, RawMesh& welded,
                        storage::RecordSpool<std::uint32_t>& table, const ImportRoom& room) {
  const std::size_t words = (mesh.fits_float ? 3 : 6) + mesh.channels();
  if (words <= 3)
    return weld_into<3>(mesh, welded, table, room);
  if (words <= 6)
    return weld_into<6>(mesh, welded, table, room);
  if (words <= 9)
    return weld_into<9>(mesh, welded, table, room);
  if (words <= 16)
    return weld_into<16>(mesh, welded, table, room);
  constexpr std::size_t kMost = 6 + kMaxChannels;
  return weld_into<kMost>(mesh, welded, table, room);
}

}  // namespace

namespace {

std::uint32_t number_of(const FacetColour& colour) {
  return std::uint32_t{colour[0]} << 16 | std::uint32_t{colour[1]} << 8 | colour[2];
}

/// A number below 2^24 is exact as a float, which a word holds.
template <std::size_t Words, class Scalar>
WeldCounts weld_soup_of(const storage::RecordSpool<Vec3<Scalar>>& corners,
                        const storage::RecordSpool<FacetColour>* colours, RawMesh& mesh,
                        const ImportRoom& room) {
  execution::SpoolCursor items(corners, room.cancel), kept(corners, room.cancel);
  std::optional<execution::SpoolCursor<FacetColour>> item_colours, kept_colours;
  if (colours != nullptr) {
    item_colours.emplace(*colours, room.cancel);
    kept_colours.emplace(*colours, room.cancel);
  }
  const std::uint64_t base = mesh.vertex_count();
  WeldCounts counts;
  Triangle<std::uint32_t> triangle{};
  std::size_t corner = 0;
  const auto take = [&](std::uint64_t number) {
    triangle[corner] = checked_number(base + number);
    if (++corner < 3)
      return;
    corner = 0;
    if (is_degenerate(triangle))
      ++counts.degenerate_triangles;
    else
      mesh.triangles.append(triangle);
  };
  const std::uint64_t stay = number_equals<Words>(
      corners.size(),
      [&](std::uint64_t i, ItemBits<Words>& bits) {
        const Vec3<Scalar>& p = items.at(i);
        for (int axis = 0; axis < 3; ++axis)
          bits.add(p[axis]);
        if (item_colours)
          bits.add(static_cast<float>(number_of(item_colours->at(i / 3))));
      },
      [&](std::uint64_t i) {
        const Vec3<Scalar>& p = kept.at(i);
        mesh.positions.append({double{p.x}, double{p.y}, double{p.z}});
        if (!kept_colours)
          return;
        for (const std::uint8_t part : kept_colours->at(i / 3))
          mesh.attributes.append(static_cast<float>(part));
      },
      take, room);
  counts.merged = corners.size() - stay;
  return counts;
}

}  // namespace

template <class Scalar>
WeldCounts weld_soup(const storage::RecordSpool<Vec3<Scalar>>& corners,
                     const storage::RecordSpool<FacetColour>* colours, RawMesh& mesh,
                     const ImportRoom& room) {
  constexpr std::size_t kWords = 3 * sizeof(Scalar) / sizeof(std::uint32_t);
  return colours == nullptr ? weld_soup_of<kWords>(corners, colours, mesh, room)
                            : weld_soup_of<kWords + 1>(corners, colours, mesh, room);
}

template WeldCounts weld_soup(const storage::RecordSpool<Vec3f>&,
                              const storage::RecordSpool<FacetColour>*, RawMesh&,
                              const ImportRoom&);
template WeldCounts weld_soup(const storage::RecordSpool<Vec3d>&,
                              const storage::RecordSpool<FacetColour>*, RawMesh&,
                              const ImportRoom&);

WeldCounts weld_vertices(RawMesh& mesh, RawMesh& welded, const ImportRoom& room) {
  welded.layout = mesh.layout;
  welded.fits_float = mesh.fits_float;
  storage::RecordSpool<std::uint32_t> table(room.scratch, kImportSpoolBytes);
  WeldCounts counts;
  counts.merged = mesh.vertex_count() - weld_into(mesh, welded, table, room);
  mesh.positions.clear();
  mesh.attributes.clear();
  renumber_triangles(mesh.triangles, table, room, [&](const Triangle<std::uint32_t>& t) {
    if (is_degenerate(t))
      ++counts.degenerate_triangles;
    else
      welded.triangles.append(t);
  });
  mesh.triangles.clear();
  return counts;
}

}  // namespace meshhier::importing
