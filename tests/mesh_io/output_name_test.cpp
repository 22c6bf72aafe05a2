#include "mesh_io/output_name.h"

#include "tests/support/error_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

std::string refusal_of_name(std::string_view name) {
  return meshhier::tests::usage_error([&] { require_true_ending(name, {".ply"}, "name it .ply"); });
}

TEST(OutputNameTest, OtherFormatsEndingsAreRefused) {
  for (const char* name : {"a.glb", "models/a.ZIP", "a.ply.gz", "a.html", "a.obj", "a.3tz", ".png"})
    EXPECT_NE(refusal_of_name(name), "") << name;
  EXPECT_EQ(refusal_of_name("a.GLB"), "a.GLB: name it .ply");
}

TEST(OutputNameTest, AnythingElseIsAName) {
  for (const char* name :
       {"a.ply", "a.PLY", "a", "a.v2", "-", "/dev/stdout", "a.glb/b", "zip", "a."})
    EXPECT_EQ(refusal_of_name(name), "") << name;
}

}  // namespace
}  // namespace meshhier::mesh_io::tests
