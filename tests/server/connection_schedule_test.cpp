#include "server/connection_schedule.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

using Milliseconds = std::chrono::milliseconds;

/// Times are milliseconds after an arbitrary start.
class ConnectionScheduleTest : public testing::Test {
 protected:
  static ConnectionSchedule::Clock::time_point at(int milliseconds) {
    return ConnectionSchedule::Clock::time_point{} + Milliseconds(milliseconds);
  }

  void add_ready(const std::string& client, int count = 1) {
    for (int i = 0; i < count; ++i)
      schedule_.add({.client = client, .since = at(0), .is_ready = true});
  }
  void add_silent(const std::string& client, int since) {
    schedule_.add({.client = client, .since = at(since)});
  }

  /// Takes all that may be served; their clients.
  std::vector<std::string> serve_all() {
    std::vector<std::string> clients;
    while (const auto next = schedule_.take_next())
      clients.push_back(next->client);
    return clients;
  }
  std::vector<std::string> pending() {
    std::vector<std::string> clients;
    for (const auto& [id, connection] : schedule_.pending())
      clients.push_back(connection.client);
    return clients;
  }

  ConnectionSchedule schedule_{
      {.threads = 4, .connections = 6},
      {.idle = Milliseconds(300), .patience = Milliseconds(100), .head = Milliseconds(200)}};
};

TEST_F(ConnectionScheduleTest, ReadyConnectionsAreServedInTheOrderTheyCameIn) {
  add_silent("a", 0);
  add_ready("b");
  add_ready("a");
  EXPECT_EQ(serve_all(), (std::vector<std::string>{"b", "a"}));
  EXPECT_EQ(schedule_.served(), 2U);
  EXPECT_EQ(pending(), std::vector<std::string>{"a"});
}

TEST_F(ConnectionScheduleTest, OneClientLeavesAThreadForTheNextOne) {
  add_ready("a", 5);
  EXPECT_EQ(serve_all().size(), 3U);
  add_ready("b", 2);
  EXPECT_EQ(serve_all(), std::vector<std::string>{"b"});
  schedule_.release("a");
  EXPECT_EQ(serve_all(), std::vector<std::string>{"a"});
  schedule_.release("a");
  schedule_.release("b");
  EXPECT_EQ(serve_all(), (std::vector<std::string>{"a", "b"}));
}

TEST_F(ConnectionScheduleTest, NobodyYieldsToARequestThatAThreadIsFreeFor) {
  add_ready("a");
  serve_all();
  add_ready("a");
  add_ready("b");
  EXPECT_TRUE(schedule_.has_next());
  EXPECT_FALSE(schedule_.must_yield("a"));
}

TEST_F(ConnectionScheduleTest, ASlowReplyYieldsWhenAllThreadsServe) {
  add_ready("a", 3);
  add_ready("b");
  ASSERT_EQ(serve_all().size(), 4U);
  EXPECT_FALSE(schedule_.must_yield("a")) << "nobody waits";
  add_silent("c", 0);
  EXPECT_FALSE(schedule_.must_yield("a")) << "nobody has asked";
  add_ready("c");
  EXPECT_TRUE(schedule_.must_yield("a"));
  EXPECT_TRUE(schedule_.must_yield("b"));
}

TEST_F(ConnectionScheduleTest, BeyondItsShareAClientKeepsOnlyItselfWaiting) {
  add_ready("b");
  add_ready("a", 4);
  ASSERT_EQ(serve_all().size(), 4U);
  EXPECT_TRUE(schedule_.must_yield("a")) << "its own requests wait for its own replies";
  EXPECT_FALSE(schedule_.must_yield("b")) << "it has one thread, the other one three";
  schedule_.release("b");
  EXPECT_FALSE(schedule_.has_next());
  EXPECT_TRUE(schedule_.must_yield("a")) << "the free thread is not for it";
}

TEST_F(ConnectionScheduleTest, TheOldestOfTheClientWithTheMostConnectionsMakesRoom) {
  add_ready("a");
  add_silent("b", 0);
  add_ready("a");
  add_silent("a", 0);
  add_silent("a", 1);
  EXPECT_TRUE(schedule_.make_room(at(1000)));
  EXPECT_EQ(pending().size(), 5U) << "there was room";
  add_silent("b", 2);
  EXPECT_FALSE(schedule_.make_room(at(99))) << "it has not waited too long";
  EXPECT_TRUE(schedule_.make_room(at(100)));
  EXPECT_EQ(pending(), (std::vector<std::string>{"a", "b", "a", "a", "b"}));
  EXPECT_EQ(schedule_.pending().rbegin()->second.client, "b");
  EXPECT_FALSE(schedule_.pending().contains(3)) << "the first that is not ready";
}

TEST_F(ConnectionScheduleTest, ServedConnectionsCountWhereRoomIsMade) {
  add_ready("a", 2);
  serve_all();
  add_silent("b", 0);
  add_silent("b", 0);
  add_silent("a", 0);
  add_silent("a", 0);
  EXPECT_TRUE(schedule_.make_room(at(100)));
  EXPECT_EQ(pending(), (std::vector<std::string>{"b", "b", "a"}));
}

TEST_F(ConnectionScheduleTest, ReadyConnectionsAreNeverClosed) {
  add_ready("a", 6);
  EXPECT_FALSE(schedule_.make_room(at(1'000'000)));
  EXPECT_FALSE(schedule_.drop_timed_out(at(1'000'000)));
  EXPECT_EQ(pending().size(), 6U);
}

TEST_F(ConnectionScheduleTest, ABegunRequestHasLessTimeThanAnIdleConnection) {
  add_silent("idle", 0);
  schedule_.add({.client = "begun", .since = at(0), .has_begun = true});
  EXPECT_FALSE(schedule_.drop_timed_out(at(199)));
  EXPECT_TRUE(schedule_.drop_timed_out(at(200)));
  EXPECT_EQ(pending(), std::vector<std::string>{"idle"});
  EXPECT_TRUE(schedule_.drop_timed_out(at(300)));
  EXPECT_TRUE(pending().empty());
}

}  // namespace
}  // namespace meshhier::server
