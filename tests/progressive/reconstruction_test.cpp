#include "progressive/reconstruction.h"

#include "base/error.h"
#include "progressive/residual.h"
#include "tests/support/error_message.h"

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::progressive {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StrEq;

using Numbers = Triangle<std::uint32_t>;

/// Vertices of a run at these places; `known` is what the client has in each one's slot.
VertexRun vertices(const std::vector<std::uint32_t>& indices,
                   const std::vector<std::array<float, 3>>& places,
                   const std::vector<std::array<float, 3>>& predicted) {
  VertexRun run{indices, std::vector<std::uint32_t>(3 * indices.size())};
  for (std::size_t i = 0; i < indices.size(); ++i)
    find_residuals({}, places[i], predicted[i], std::span(run.residuals).subspan(3 * i, 3));
  return run;
}

/// As a first run has them: each predicted from the one before.
VertexRun first_vertices(const std::vector<std::uint32_t>& indices) {
  std::vector<std::array<float, 3>> places, predicted;
  std::array<float, 3> before{};
  for (const std::uint32_t index : indices) {
    predicted.push_back(before);
    before = {static_cast<float>(index), 0.5F, -1};
    places.push_back(before);
  }
  return vertices(indices, places, predicted);
}

struct Mesh {
  std::vector<float> values;
  std::vector<Numbers> triangles;
};

Mesh handed_out(Reconstruction mesh) {
  Mesh out;
  std::move(mesh).hand_out(
      [&](std::span<const float> v) { out.values.insert(out.values.end(), v.begin(), v.end()); },
      [&](std::span<const Numbers> t) {
        out.triangles.insert(out.triangles.end(), t.begin(), t.end());
      });
  return out;
}

void put(Reconstruction& mesh, const DetailRun& run) {
  mesh.apply(run);
}

std::string flaw(Reconstruction& mesh, const DetailRun& run) {
  return tests::error_message(ErrorCode::corrupt, [&] { mesh.apply(run); });
}

/// Six slots, of which four are the node's own, and three triangles.
Reconstruction small() {
  return {{6, 4, 3}, {}};
}

TEST(Reconstruction, VerticesAreNumberedInTheOrderOfTheirSlots) {
  Reconstruction mesh = small();
  put(mesh, first_vertices({1, 3}));
  put(mesh, first_vertices({4}));
  put(mesh, TriangleRun{{0, 2}, {{1, 3, 4}, {4, 1, 3}}});
  EXPECT_EQ(mesh.shown_vertices(), 3U);
  EXPECT_EQ(mesh.shown_triangles(), 2U);
  const Mesh out = handed_out(std::move(mesh));
  EXPECT_THAT(out.values, ElementsAre(1, 0.5F, -1, 3, 0.5F, -1, 4, 0.5F, -1));
  EXPECT_THAT(out.triangles, ElementsAre(Numbers{0, 1, 2}, Numbers{2, 0, 1}));
}

TEST(Reconstruction, AVertexThatStandsForOthersIsWrittenOnce) {
  Reconstruction mesh = small();
  put(mesh, first_vertices({0, 3, 5}));
  put(mesh, TriangleRun{{1}, {{1, 2, 5}}});
  put(mesh, MergeRun{{1, 2}, {3, 0}});
  const Mesh out = handed_out(std::move(mesh));
  EXPECT_EQ(out.values.size(), 9U);
  EXPECT_THAT(out.triangles, ElementsAre(Numbers{1, 0, 2}));
}

TEST(Reconstruction, AVertexThatAppearsIsPredictedFromWhatStoodForIt) {
  Reconstruction mesh = small();
  put(mesh, first_vertices({3}));
  put(mesh, MergeRun{{1, 2}, {3, 3}});
  put(mesh, vertices({1}, {{7, 8, 9}}, {{3, 0.5F, -1}}));
  put(mesh, MergeRun{{2}, {1}});  // moves on
  put(mesh, TriangleRun{{0}, {{1, 2, 3}}});
  const Mesh out = handed_out(std::move(mesh));
  EXPECT_THAT(out.values, ElementsAre(7, 8, 9, 3, 0.5F, -1));
  EXPECT_THAT(out.triangles, ElementsAre(Numbers{0, 0, 1}));
}

TEST(Reconstruction, ForeignVerticesMoveAndCountOnce) {
  Reconstruction mesh = small();
  put(mesh, first_vertices({4, 5}));
  put(mesh, vertices({4, 5}, {{1, 2, 3}, {4, 5, 6}}, {{4, 0.5F, -1}, {5, 0.5F, -1}}));
  EXPECT_EQ(mesh.shown_vertices(), 2U);
  EXPECT_THAT(handed_out(std::move(mesh)).values, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Reconstruction, OwnVerticesAppearOnce) {
  Reconstruction mesh = small();
  put(mesh, first_vertices({3}));
  EXPECT_THAT(flaw(mesh, first_vertices({3})), StrEq("vertex 3 appears twice"));
}

TEST(Reconstruction, IndicesBeyondTheMeshAreRefused) {
  Reconstruction mesh = small();
  put(mesh, first_vertices({0, 5}));
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  EXPECT_THAT(flaw(mesh, first_vertices({6})), StrEq("vertex 6 is beyond the mesh"));
  EXPECT_THAT(flaw(mesh, first_vertices({kMost})), StrEq("vertex 4294967295 is beyond the mesh"));
  EXPECT_THAT(flaw(mesh, TriangleRun{{3}, {{0, 0, 5}}}), StrEq("triangle 3 is beyond the mesh"));
  EXPECT_THAT(flaw(mesh, TriangleRun{{INT64_MAX}, {{0, 0, 5}}}),
              StrEq("triangle 9223372036854775807 is beyond the mesh"));
  for (const std::uint32_t corner : {6U, kMost}) {
    for (const Numbers& corners : {Numbers{corner, 0, 5}, {0, corner, 5}, {0, 5, corner}})
      EXPECT_THAT(flaw(mesh, TriangleRun{{1}, {corners}}),
                  StrEq("triangle 1 has a corner beyond the mesh"));
    EXPECT_THAT(flaw(mesh, MergeRun{{1}, {corner}}), StrEq("merge of vertex 1 is beyond the mesh"));
  }
  EXPECT_THAT(flaw(mesh, MergeRun{{6}, {0}}), StrEq("merge of vertex 6 is beyond the mesh"));
}

TEST(Reconstruction, ATriangleAppearsOnce) {
  Reconstruction mesh = small();
  put(mesh, TriangleRun{{2}, {{0, 1, 2}}});
  EXPECT_THAT(flaw(mesh, TriangleRun{{2}, {{0, 1, 2}}}), StrEq("triangle 2 appears twice"));
}

TEST(Reconstruction, APlaceIsFinite) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const float value : {kInfinity, -kInfinity, kNan}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Reconstruction mesh = small();
      std::array<float, 3> place{1, 2, 3};
      place[axis] = value;
      EXPECT_THAT(flaw(mesh, vertices({1}, {place}, {{0, 0, 0}})),
                  StrEq("vertex 1 has no finite place"));
    }
  }
}

TEST(Reconstruction, MergesNeedAVertexThatIsThere) {
  Reconstruction mesh = small();
  put(mesh, first_vertices({0}));
  EXPECT_THAT(flaw(mesh, MergeRun{{1}, {2}}),
              StrEq("merge of vertex 1 is with a vertex that is nowhere"));
  EXPECT_THAT(flaw(mesh, MergeRun{{1}, {1}}),
              StrEq("merge of vertex 1 is with a vertex that is nowhere"));
  EXPECT_THAT(flaw(mesh, MergeRun{{0}, {0}}),
              StrEq("merge of vertex 0 comes after the vertex itself"));
}

TEST(Reconstruction, ATriangleWhoseCornerIsNowhereIsNotHandedOut) {
  for (const Numbers& corners : {Numbers{5, 0, 1}, {0, 5, 1}, {0, 1, 5}}) {
    Reconstruction mesh = small();
    put(mesh, first_vertices({0, 1}));
    put(mesh, TriangleRun{{1}, {corners}});
    try {
      handed_out(std::move(mesh));
      ADD_FAILURE() << "handed out";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::corrupt);
      EXPECT_THAT(error.what(), StrEq("triangle 1 has a corner that is nowhere"));
    }
  }
}

TEST(Reconstruction, NothingIsHandedOutAsNothing) {
  const Mesh out = handed_out(small());
  EXPECT_THAT(out.values, IsEmpty());
  EXPECT_THAT(out.triangles, IsEmpty());
}

TEST(Reconstruction, BlocksOfAnySizeAddUp) {
  for (const std::uint32_t count : {16383U, 16384U, 16385U, 40000U}) {
    Reconstruction mesh({count, count, count}, {});
    std::vector<std::uint32_t> indices(count);
    TriangleRun triangles;
    for (std::uint32_t i = 0; i < count; ++i) {
      indices[i] = i;
      triangles.indices.push_back(i);
      triangles.corners.push_back({i, (i + 1) % count, 0});
    }
    put(mesh, first_vertices(indices));
    put(mesh, triangles);
    const Mesh out = handed_out(std::move(mesh));
    ASSERT_EQ(out.values.size(), 3 * std::size_t{count});
    EXPECT_EQ(out.values[3 * (count - 1)], static_cast<float>(count - 1));
    EXPECT_EQ(out.triangles, triangles.corners);
  }
}

TEST(Reconstruction, TheArraysTakeWhatIsTold) {
  EXPECT_EQ(Reconstruction::memory_bytes({6, 4, 3}, {}), 6U * 16 + 3 * 12);
  EXPECT_EQ(Reconstruction::memory_bytes({6, 4, 3}, {true, ColourType::u8, true, true}),
            6U * 52 + 3 * 12);
}

}  // namespace
}  // namespace meshhier::progressive
