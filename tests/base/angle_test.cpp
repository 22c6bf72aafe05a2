#include "base/angle.h"

#include "base/power_of_two.h"
#include "storage/io/hash.h"
#include "tests/support/meshes.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

constexpr double kClose = 1e-14;

TEST(AngleTest, ATurnHasTheCosineAndTheSineOfItsAngle) {
  for (int i = -4096; i <= 4096; ++i) {
    const double angle = i / 2048.0 * std::numbers::pi;
    const UnitTurn turn = turn_by(angle);
    EXPECT_NEAR(turn.cosine, std::cos(angle), kClose) << angle;
    EXPECT_NEAR(turn.sine, std::sin(angle), kClose) << angle;
  }
  EXPECT_EQ(turn_by(0).cosine, 1);
  EXPECT_EQ(turn_by(0).sine, 0);
}

TEST(AngleTest, AnAngleIsThatOfItsDirectionHoweverLong) {
  for (int i = 0; i <= 4096; ++i) {
    const double angle = i / 4096.0 * std::numbers::pi;
    for (const double size : {1e-90, 1e-7, 1.0, 1e76}) {
      const double x = size * std::cos(angle);
      const double y = std::abs(size * std::sin(angle));
      EXPECT_NEAR(angle_of(x, y), std::atan2(y, x), kClose) << angle << ' ' << size;
    }
  }
  EXPECT_EQ(angle_of(0, 0), 0);
  EXPECT_EQ(angle_of(3, 0), 0);
  EXPECT_NEAR(angle_of(-3, 0), std::numbers::pi, kClose);
}

TEST(AngleTest, AngleAndTurnAreInverses) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const double angle = std::abs(double{tests::hash_noise(i, 7)}) * std::numbers::pi;
    const UnitTurn turn = turn_by(angle);
    EXPECT_NEAR(angle_of(turn.cosine, turn.sine), angle, kClose);
  }
}

// Another value means another compiler or processor, or other code: hierarchies would differ, too.
TEST(AngleTest, TheBitsAreTheSameEverywhere) {
  std::vector<double> turns;
  std::vector<double> angles;
  for (int i = 0; i < 1000; ++i) {
    const UnitTurn turn = turn_by((i - 500) / 128.0);
    turns.insert(turns.end(), {turn.cosine, turn.sine});
    angles.push_back(angle_of(i * 7919 % 2001 - 1000, i * 104729 % 997));
  }
  EXPECT_EQ(storage::checksum(std::as_bytes(std::span(turns))), 5383447823420107832U);
  EXPECT_EQ(storage::checksum(std::as_bytes(std::span(angles))), 10766985568894622259U);
}

TEST(PowerOfTwoTest, IsTheNextOneOrTheSame) {
  EXPECT_EQ(power_of_two_from(1), 1);
  EXPECT_EQ(power_of_two_from(1024), 1024);
  EXPECT_EQ(power_of_two_from(1025), 2048);
  EXPECT_EQ(power_of_two_from(0.3), 0.5);
  EXPECT_EQ(power_of_two_from(std::nextafter(8.0, 9.0)), 16);
  EXPECT_EQ(power_of_two_from(std::numeric_limits<double>::denorm_min()),
            std::numeric_limits<double>::denorm_min());
}

}  // namespace
}  // namespace meshhier
