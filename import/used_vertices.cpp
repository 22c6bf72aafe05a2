#include "import/used_vertices.h"

#include "base/error.h"
#include "execution/spool_cursor.h"

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

namespace meshhier::importing {
namespace {

using Triangles = storage::RecordSpool<Triangle<std::uint32_t>>;

constexpr std::uint64_t kWordVertices = 64;
/// A word of bits and the number of bits before it.
constexpr std::uint64_t kWordBytes = 12;
constexpr std::uint64_t kLeastWords = 64;

/// The vertices of [begin, end) that are used, a bit each.
class UseTable {
 public:
  UseTable(std::uint64_t begin, std::uint64_t end)
      : begin_(begin), words_((end - begin + kWordVertices - 1) / kWordVertices) {}

  void mark(std::uint32_t vertex) { word(vertex) |= bit(vertex); }
  /// Ends marking. `before`: vertices before begin that are used.
  void count(std::uint32_t before) {
    counts_.reserve(words_.size());
    for (const std::uint64_t word : words_) {
      counts_.push_back(before);
      before += static_cast<std::uint32_t>(std::popcount(word));
    }
  }
  /// Returns how many marked ones are before a marked vertex.
  std::uint32_t number(std::uint32_t vertex) const {
    const std::size_t index = (vertex - begin_) / kWordVertices;
    return counts_[index] +
           static_cast<std::uint32_t>(std::popcount(words_[index] & (bit(vertex) - 1)));
  }
  void append_to(storage::RecordSpool<std::uint32_t>& used) const {
    for (std::size_t i = 0; i < words_.size(); ++i) {
      for (std::uint64_t rest = words_[i]; rest != 0; rest &= rest - 1) {
        used.append(static_cast<std::uint32_t>(begin_ + i * kWordVertices +
                                               static_cast<unsigned>(std::countr_zero(rest))));
      }
    }
  }

 private:
  std::uint64_t& word(std::uint32_t vertex) { return words_[(vertex - begin_) / kWordVertices]; }
  std::uint64_t bit(std::uint32_t vertex) const {
    return std::uint64_t{1} << ((vertex - begin_) % kWordVertices);
  }

  std::uint64_t begin_;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> counts_;
};

/// Gives the vertices of [begin, end) their numbers. Corners before `begin` have theirs; as no
/// number is above its vertex's, the others are told from them.
void renumber(const Triangles& triangles, std::uint64_t begin, std::uint64_t end, Triangles& to,
              storage::RecordSpool<std::uint32_t>& used, const ImportRoom& room) {
  const auto is_here = [&](std::uint32_t corner) { return corner >= begin && corner < end; };
  UseTable table(begin, end);
  execution::SpoolCursor all(triangles, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t corner : all.at(i)) {
      if (is_here(corner))
        table.mark(corner);
    }
  }
  table.count(static_cast<std::uint32_t>(used.size()));
  table.append_to(used);
  execution::SpoolCursor again(triangles, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    Triangle<std::uint32_t> triangle = again.at(i);
    for (std::uint32_t& corner : triangle) {
      if (is_here(corner))
        corner = table.number(corner);
    }
    to.append(triangle);
  }
}

void append_moved(const Triangles& triangles, std::uint64_t base, bool turned, RawMesh& mesh,
                  const ImportRoom& room) {
  const auto moved = [&](std::uint32_t corner) {
    return static_cast<std::uint32_t>(base + corner);
  };
  execution::SpoolCursor all(triangles, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    const auto [a, b, c] = all.at(i);
    mesh.triangles.append(
        Triangle<std::uint32_t>{moved(a), moved(turned ? c : b), moved(turned ? b : c)});
  }
}

}  // namespace

void append_used(std::unique_ptr<Triangles> triangles, std::uint64_t vertex_count, bool turned,
                 RawMesh& mesh, storage::RecordSpool<std::uint32_t>& used, const ImportRoom& room) {
  const std::uint64_t part = std::max(room.sort_bytes / kWordBytes, kLeastWords) * kWordVertices;
  for (std::uint64_t begin = 0; begin < vertex_count; begin += part) {
    auto renumbered = std::make_unique<Triangles>(room.scratch, kImportSpoolBytes);
    renumber(*triangles, begin, std::min(begin + part, vertex_count), *renumbered, used, room);
    triangles = std::move(renumbered);
  }
  if (mesh.vertex_count() + used.size() >= UINT32_MAX)
    throw Error(ErrorCode::input, "the input has 2^32 vertices or more; split it");
  append_moved(*triangles, mesh.vertex_count(), turned, mesh, room);
}

}  // namespace meshhier::importing
