#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "progressive/detail_file.h"
#include "progressive/reconstruction.h"
#include "storage/format/gzip.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace meshhier::tests::fuzz {
namespace {

using progressive::Reconstruction;
using progressive::StreamSize;

constexpr std::uint32_t kStep = 1;
constexpr StreamSize kSize{3000, 2000, 4000};

AttributeLayout take_layout(Take& take) {
  const auto bits = take.number<std::uint8_t>();
  return {(bits & 1) != 0, static_cast<ColourType>(bits >> 1 & 3), (bits & 8) != 0,
          (bits & 16) != 0};
}

/// A file of runs, each told by its list, its entries and the bytes that are to be packed.
std::vector<std::byte> packed_file(Take& take) {
  std::vector<std::byte> file = progressive::detail_head(kStep);
  while (!take.rest().empty()) {
    const auto list = std::uint32_t{take.number<std::uint8_t>()};
    const auto entries = std::uint32_t{take.number<std::uint16_t>()};
    const auto asked = std::size_t{take.number<std::uint16_t>()};
    const std::size_t size = std::min(asked, take.rest().size());
    const std::vector<std::byte> packed = storage::gzip(take.rest().first(size));
    take = Take(take.rest().subspan(size));
    storage::append_little(file, list);
    storage::append_little(file, entries);
    storage::append_little(file, static_cast<std::uint32_t>(packed.size()));
    file.insert(file.end(), packed.begin(), packed.end());
  }
  return file;
}

bool same(const DetailRun& a, const DetailRun& b) {
  const auto equal = [&](const auto& list) {
    const auto& other = std::get<std::decay_t<decltype(list)>>(b);
    if constexpr (requires { list.residuals; })
      return list.indices == other.indices && list.residuals == other.residuals;
    else if constexpr (requires { list.corners; })
      return list.indices == other.indices && list.corners == other.corners;
    else
      return list.indices == other.indices && list.targets == other.targets;
  };
  return a.index() == b.index() && std::visit(equal, a);
}

/// Sound, and the same once it is stored and read again.
void check_run(const DetailRun& run, const AttributeLayout& layout, std::uint64_t first) {
  std::visit(
      [&](const auto& list) {
        require(!list.indices.empty() && list.indices.size() <= kRunEntries, "some entries");
        require(std::ranges::adjacent_find(list.indices, std::ranges::greater_equal()) ==
                    list.indices.end(),
                "ascending");
        require(list.indices.front() >= first, "behind the run before");
      },
      run);
  std::vector<std::byte> file = progressive::detail_head(kStep);
  const std::vector<std::byte> bytes = progressive::encode_run(run, layout, 0);
  file.insert(file.end(), bytes.begin(), bytes.end());
  progressive::DetailFileReader reader(file, kStep, layout, "again.bin");
  const std::optional<DetailRun> again = reader.next();
  require(again && same(run, *again), "what is written is read again");
  require(!reader.next(), "and nothing else");
}

void check_mesh(Reconstruction mesh, std::size_t width) {
  const std::uint64_t vertices = mesh.shown_vertices();
  const std::uint64_t triangles = mesh.shown_triangles();
  std::uint64_t values_seen = 0, triangles_seen = 0;
  const std::string refused = refusal({ErrorCode::corrupt}, "triangle ", [&] {
    std::move(mesh).hand_out(
        [&](std::span<const float> values) { values_seen += values.size(); },
        [&](std::span<const Triangle<std::uint32_t>> block) {
          triangles_seen += block.size();
          for (const auto& t : block) {
            require(std::ranges::all_of(t, [&](std::uint32_t v) { return v < vertices; }),
                    "corners are vertices that were handed out");
          }
        });
  });
  require(values_seen == vertices * width, "as many vertices as there are");
  require(!refused.empty() || triangles_seen == triangles, "as many triangles as there are");
}

void read_file(Bytes bytes, const AttributeLayout& layout) {
  Reconstruction mesh(kSize, layout);
  std::array<std::uint64_t, 3> first{};
  bool applied = true;
  refusal({ErrorCode::corrupt}, "detail_01.bin: ", [&] {
    progressive::DetailFileReader reader(bytes, kStep, layout, "detail_01.bin");
    while (const std::optional<DetailRun> run = reader.next()) {
      check_run(*run, layout, first[run->index()]);
      first[run->index()] =
          std::visit([](const auto& list) { return std::uint64_t{list.indices.back()} + 1; }, *run);
      applied = applied && refusal({ErrorCode::corrupt}, "", [&] { mesh.apply(*run); }).empty();
    }
  });
  if (applied)
    check_mesh(std::move(mesh), static_cast<std::size_t>(vertex_values(layout)));
}

}  // namespace

void detail(Bytes input) {
  Take take(input);
  const bool is_file = (take.number<std::uint8_t>() & 1) != 0;
  const AttributeLayout layout = take_layout(take);
  if (is_file)
    return read_file(take.rest(), layout);
  read_file(packed_file(take), layout);
}

}  // namespace meshhier::tests::fuzz
