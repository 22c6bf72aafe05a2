#include "import/find_copies.h"

#include "execution/parallel.h"
#include "execution/spool_cursor.h"
#include "import/text_blocks.h"
#include "partition/external_sort.h"

#include <algorithm>
#include <array>
#include <bit>
#include <mutex>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>
#include <vector>

namespace meshhier::importing {
namespace {

/// The positions of a bucket: it is settled in the L2 cache.
constexpr std::uint64_t kBucketPositions = 8192;
/// The least bytes that a bucket writes at a time, if there are many in little memory; and the
/// most.
constexpr std::uint64_t kLeastBucketBytes = 4096;
constexpr std::uint64_t kMostBucketBytes = 65536;
/// The part of the memory, one in so many, that buckets have for writing.
constexpr std::uint64_t kWritingParts = 4;

/// A position by its bits, of which equal coordinates have equal ones, and its vertex.
template <std::size_t Words>
struct Located {
  std::array<std::uint32_t, Words> bits;
  std::uint32_t id;
  friend auto operator<=>(const Located&, const Located&) = default;

  /// Its high bits are mixed best.
  std::uint64_t hash() const {
    std::uint64_t key = 0;
    for (const std::uint32_t word : bits)
      key = (key + word) * 0x9E3779B97F4A7C15;  // 2^64 over the golden ratio
    return key;
  }
};

Located<3> located(Vec3f p, std::uint32_t id) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x + 0.0F); };
  return {{bits(p.x), bits(p.y), bits(p.z)}, id};
}

Located<6> located(Vec3d p, std::uint32_t id) {
  Located<6> result{{}, id};
  for (int axis = 0; axis < 3; ++axis) {
    const auto bits = std::bit_cast<std::uint64_t>(p[axis] + 0.0);
    result.bits[2 * axis] = static_cast<std::uint32_t>(bits >> 32);
    result.bits[2 * axis + 1] = static_cast<std::uint32_t>(bits);
  }
  return result;
}

/// The `count` bits of a hash behind the first `skipped`.
std::size_t hash_bits(std::uint64_t hash, int skipped, int count) {
  return static_cast<std::size_t>(hash << skipped >> 1 >> (63 - count));
}

/// Vertices in groups, one after another.
template <std::size_t Words>
struct Grouped {
  std::vector<Located<Words>> vertices;
  std::vector<std::uint32_t> ends;  ///< the end of each group

  std::span<Located<Words>> group(std::size_t i) {
    const std::uint32_t begin = i == 0 ? 0 : ends[i - 1];
    return std::span(vertices).subspan(begin, ends[i] - begin);
  }

  /// Takes them over by `group_of(vertex)`, below `groups`.
  template <class GroupOf>
  void fill(std::span<const Located<Words>> from, std::size_t groups, const GroupOf& group_of) {
    ends.assign(groups + 1, 0);
    for (const Located<Words>& vertex : from)
      ++ends[group_of(vertex) + 1];
    for (std::size_t i = 1; i <= groups; ++i)
      ends[i] += ends[i - 1];
    vertices.resize(from.size());
    for (const Located<Words>& vertex : from)
      vertices[ends[group_of(vertex)]++] = vertex;
    ends.pop_back();
  }
};

/// Tells the copies among vertices that come by place, and by id at each.
template <std::size_t Words>
class CopyFinder {
 public:
  template <class Take>
  void add(const Located<Words>& vertex, const Take& take) {
    if (slot_ == kNone || vertex.bits != first_.bits) {
      first_ = vertex;
      slot_ = 0;
    } else {
      take(CopyVertex{vertex.id, first_.id, ++slot_});
    }
  }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  Located<Words> first_{};
  std::uint32_t slot_ = kNone;
};

struct ById {
  std::uint32_t operator()(const CopyVertex& copy) const { return copy.id; }
};
struct ByPlace {
  template <std::size_t Words>
  auto operator()(const Located<Words>& vertex) const {
    return std::tuple(vertex.hash(), vertex);
  }
};

/// All vertices in buckets.
template <std::size_t Words>
class Buckets {
 public:
  using Vertex = Located<Words>;

  Buckets(std::uint64_t vertices, const LookRoom& room) : room_(room) {
    const std::uint64_t writing = room.memory_bytes / kWritingParts;
    const std::uint64_t most = std::max<std::uint64_t>(writing / kLeastBucketBytes, 1);
    const std::uint64_t count =
        std::min(std::bit_ceil(vertices / kBucketPositions + 1), std::bit_floor(most));
    bits_ = std::countr_zero(count);
    const std::uint64_t bytes = std::clamp(writing / count, kLeastBucketBytes, kMostBucketBytes);
    buckets_.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i)
      buckets_.emplace_back(room.scratch, bytes);
    locks_ = std::vector<std::mutex>(count);
    settling_bytes_ = (room.memory_bytes - writing) / 2;
    // Hashes are about even: few buckets have twice what they have on average.
    in_flight_ = std::clamp<std::uint64_t>(
        settling_bytes_ / (2 * settling_bytes(vertices / count + 1)), 1, room.blocks_in_flight);
  }

  /// Groups vertices by buckets. Thread-safe for different results.
  void spread(std::span<const Vertex> vertices, Grouped<Words>& result) const {
    result.fill(vertices, buckets_.size(),
                [&](const Vertex& vertex) { return hash_bits(vertex.hash(), 0, bits_); });
  }

  /// Appends vertices to the buckets; their order decides nothing. Thread-safe.
  void append(Grouped<Words>& spread) {
    for (std::size_t i = 0; i < buckets_.size(); ++i) {
      const std::span<Vertex> group = spread.group(i);
      if (group.empty())
        continue;
      const std::lock_guard lock(locks_[i]);
      buckets_[i].append(group);
    }
  }

  CopyList settle(storage::ScratchFile& list) {
    execution::ordered_blocks<Settled>(
        buckets_.size(), in_flight_, room_.cancel,
        [&](std::uint64_t i, Settled& settled) {
          settled.copies.clear();
          if (fits(buckets_[i]))
            settle(buckets_[i], settled);
        },
        [&](const Settled& settled) {
          for (const CopyVertex& copy : settled.copies)
            note(copy);
          return true;
        });
    // Buckets that did not fit beside the others come one by one, with all memory.
    for (Bucket& bucket : buckets_) {
      if (bucket.size() > 0)
        settle_sorted(bucket);
    }
    return take(list);
  }

 private:
  using Bucket = storage::RecordSpool<Vertex>;
  struct Settled {
    std::vector<Vertex> read;
    Grouped<Words> grouped;
    std::vector<CopyVertex> copies;
  };

  /// Returns the memory for a bucket of so many vertices.
  static std::uint64_t settling_bytes(std::uint64_t vertices) {
    return vertices * (2 * sizeof(Vertex) + 2 * sizeof(std::uint32_t) + sizeof(CopyVertex)) +
           sizeof(Settled);
  }
  bool fits(const Bucket& bucket) const {
    return settling_bytes(bucket.size()) <= settling_bytes_ / in_flight_;
  }

  void settle(Bucket& bucket, Settled& settled) const {
    settled.read.resize(bucket.size());
    bucket.read(0, settled.read);
    bucket.clear();
    // The bits behind those that chose the bucket choose a group of about one vertex, so that
    // sorting costs next to nothing.
    const std::size_t groups = std::bit_ceil(settled.read.size());
    const int group_bits = std::countr_zero(groups);
    settled.grouped.fill(settled.read, groups, [&](const Vertex& vertex) {
      return hash_bits(vertex.hash(), bits_, group_bits);
    });
    for (std::size_t i = 0; i < groups; ++i) {
      const std::span<Vertex> group = settled.grouped.group(i);
      if (group.size() < 2)
        continue;
      std::sort(group.begin(), group.end());
      CopyFinder<Words> finder;
      for (const Vertex& vertex : group)
        finder.add(vertex, [&](const CopyVertex& copy) { settled.copies.push_back(copy); });
    }
  }

  void settle_sorted(Bucket& bucket) {
    partition::ExternalSort<Vertex, ByPlace> sort(room_.scratch, settling_bytes_);
    execution::SpoolCursor vertices(bucket, room_.cancel);
    for (std::uint64_t i = 0; i < vertices.size(); ++i)
      sort.add(vertices.at(i));
    bucket.clear();
    sort.sort();
    CopyFinder<Words> finder;
    sort.for_each_block([&](std::span<const Vertex> block) {
      room_.cancel.check();
      for (const Vertex& vertex : block)
        finder.add(vertex, [&](const CopyVertex& copy) { note(copy); });
    });
  }

  void note(const CopyVertex& copy) {
    if (!copies_)
      copies_.emplace(room_.scratch, settling_bytes_);
    copies_->add(copy);
  }

  CopyList take(storage::ScratchFile& scratch) {
    if (!copies_)
      return {};
    CopyList list(scratch);
    copies_->sort();
    copies_->for_each_block([&](std::span<const CopyVertex> block) {
      room_.cancel.check();
      for (const CopyVertex& copy : block)
        list.append(copy);
    });
    return list;
  }

  const LookRoom& room_;
  std::vector<Bucket> buckets_;    ///< 2^bits_, by the first bits of the hash
  std::vector<std::mutex> locks_;  ///< per bucket, of who appends
  int bits_ = 0;
  std::uint64_t settling_bytes_ = 0;
  std::size_t in_flight_ = 1;
  std::optional<partition::ExternalSort<CopyVertex, ById>> copies_;
};

template <class Scalar>
std::span<const Vec3<Scalar>> positions_of(const mesh_io::VertexBlock& block) {
  if constexpr (std::is_same_v<Scalar, float>)
    return block.positions;
  else
    return block.exact;
}

template <class Scalar>
CopyList look_at(mesh_io::MeshSource& source, storage::ScratchFile& list, const LookRoom& room) {
  constexpr std::size_t kWords = 3 * sizeof(Scalar) / sizeof(std::uint32_t);
  struct Slot {
    mesh_io::BlockMemory memory;
    std::vector<Located<kWords>> vertices;
    Grouped<kWords> spread;
  };
  Buckets<kWords> buckets(source.description().vertex_count, room);
  const auto spread = [&](const mesh_io::VertexBlock& block, Slot& slot) {
    slot.vertices.clear();
    auto id = static_cast<std::uint32_t>(block.first);
    for (const Vec3<Scalar>& position : positions_of<Scalar>(block))
      slot.vertices.push_back(located(position, id++));
    buckets.spread(slot.vertices, slot.spread);
    buckets.append(slot.spread);
    room.progress.advance(slot.vertices.size());
  };
  if (source.description().vertices_in_place) {
    execution::ordered_blocks<Slot>(
        source.vertex_blocks(), room.blocks_in_flight, room.cancel,
        [&](std::uint64_t i, Slot& slot) {
          spread(source.read_vertex_block(i, slot.memory), slot);
        },
        [](const Slot&) { return true; });
  } else {
    Slot slot;
    source.read_vertices(
        [&](const mesh_io::VertexBlock& block) {
          room.cancel.check();
          spread(block, slot);
        },
        parallel_blocks(room.blocks_in_flight, room.cancel));
  }
  return buckets.settle(list);
}

std::uint64_t located_bytes(const mesh_io::MeshDescription& mesh) {
  return mesh.wide_coordinates ? sizeof(Located<6>) : sizeof(Located<3>);
}

}  // namespace

std::uint64_t look_bytes(const mesh_io::MeshDescription& mesh) {
  return mesh.vertex_count * located_bytes(mesh);
}

std::uint64_t look_block_bytes(const mesh_io::MeshDescription& mesh) {
  const auto channels = static_cast<std::uint64_t>(mesh.attributes.channels());
  // The block as it is in the file and as it is read, and its positions twice.
  return mesh_io::MeshSource::kBlockSize * (2 * (24 + 4 * channels) + 2 * located_bytes(mesh));
}

CopyList find_copies(mesh_io::MeshSource& source, storage::ScratchFile& list,
                     const LookRoom& room) {
  return source.description().wide_coordinates ? look_at<double>(source, list, room)
                                               : look_at<float>(source, list, room);
}

}  // namespace meshhier::importing
