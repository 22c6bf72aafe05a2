#include "pipeline/texture_stage.h"

#include "tests/support/sample_hierarchy.h"

#include <cstdint>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

class TexelErrorsTest : public testing::Test {
 protected:
  void put(NodeId node, const TexelSizes& texels) { store_.put(node, {}, {}, texels); }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  storage::MemoryPool pool_{0};
  Tree tree_{100, 4};
  storage::ScratchFile scratch_{*files_, directory_.path() / "scratch", pool_};
  TextureStore store_{tree_, scratch_};
  const NodeId root_{Level{0}, 0}, left_{Level{1}, 0}, right_{Level{1}, 1};
};

TEST_F(TexelErrorsTest, ErrorsCountTexelsAndWhatPicturesLost) {
  for (std::uint32_t i = 0; i < 4; ++i)
    put({Level{2}, i}, {1, 1, 0});
  put(left_, {2, 1, 0.5f});  // larger texels
  put(right_, {1, 1, 3});    // texels as large as the input's, that show less than its
  put(root_, {2.5f, 1, 2.6f});
  const TileErrors errors = with_texels(TileErrors(tree_), tree_, store_);
  EXPECT_EQ((errors[{Level{2}, 0}].error), 0);
  EXPECT_EQ(errors[left_].error, 2);
  EXPECT_EQ(errors[right_].error, 3);
  EXPECT_GT(errors[root_].error, 3);  // no smaller than its child's
  EXPECT_LT(errors[root_].error, 3.001f);
}

TEST_F(TexelErrorsTest, TexelsAsFineAsTheInputsAreNoError) {
  put(left_, {1, 1, 0.9f});
  TileErrors errors(tree_);
  errors[left_].error = 0.25f;
  EXPECT_EQ(with_texels(std::move(errors), tree_, store_)[left_].error, 0.25f);
}

}  // namespace
}  // namespace meshhier::pipeline
