#include "pipeline/plan/tile_room.h"

#include "base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using testing::HasSubstr;

class TileRoomTest : public testing::Test {
 protected:
  TileRoomTest() {
    plan_.work_bytes = 100;
    plan_.tiles_in_flight = 4;
  }
  std::size_t in_flight(std::uint64_t heaviest) {
    return TileRoom(plan_, pool_, {heaviest}).in_flight();
  }

  MemoryPlan plan_;
  storage::MemoryPool pool_{60};
};

TEST_F(TileRoomTest, UsualTilesAreAtWorkAsPlanned) {
  EXPECT_EQ(in_flight(0), 4U);
  EXPECT_EQ(in_flight(25), 4U);
}

TEST_F(TileRoomTest, HeavierOnesAreFewerAtATime) {
  EXPECT_EQ(in_flight(26), 3U);
  EXPECT_EQ(in_flight(50), 2U);
  EXPECT_EQ(in_flight(100), 1U);
}

TEST_F(TileRoomTest, WhatOneNeedsBeyondThePlanComesFromThePoolForAWhile) {
  {
    const TileRoom room(plan_, pool_, {150});
    EXPECT_EQ(room.in_flight(), 1U);
    EXPECT_EQ(pool_.free_bytes(), 10U);
  }
  EXPECT_EQ(pool_.free_bytes(), 60U);
}

TEST_F(TileRoomTest, ARefusalNamesWhatDoesForThoseAheadToo) {
  EXPECT_EQ(TileRoom(plan_, pool_, {150, 1 << 22}).in_flight(), 1U) << "they may become fewer";
  try {
    const TileRoom room(plan_, pool_, {161, 1 << 22});
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("takes 161 B, and others up to 4"));
    EXPECT_THAT(error.what(), HasSubstr("needs a memory_budget larger by 5MiB"));
  }
}

TEST_F(TileRoomTest, ATileThatDoesNotFitIsRefusedWithWhatWouldDo) {
  try {
    in_flight(161);
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::budget);
    EXPECT_THAT(error.what(), HasSubstr("needs a memory_budget larger by 1MiB"));
  }
  EXPECT_EQ(pool_.free_bytes(), 60U);
}

}  // namespace
}  // namespace meshhier::pipeline
