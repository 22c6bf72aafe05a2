#include "pipeline/update.h"

#include "base/error.h"
#include "pipeline/build.h"
#include "storage/format/input_note.h"
#include "storage/format/layout.h"
#include "storage/format/manifest.h"
#include "storage/io/forwarding_files.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class UpdateTest : public testing::Test {
 protected:
  UpdateTest() {
    tests::write_ply(tests::sphere(1000), directory_.path() / "mesh.ply");
    config_ = tests::quick_config();
    config_.input = directory_.path() / "mesh.ply";
    config_.output = directory_.path() / "mesh.hier";
    config_.partition.vertices = 100;
    const BuildReport report = build_hierarchy(config_, {}, environment_);
    storage::write_input_note(files_, note(), report.input);
  }
  fs::path note() { return input_note_path(config_, files_); }
  std::string reason() { return reason_to_build(config_, note(), environment_); }

  storage::Manifest manifest() const {
    std::ifstream stream(storage::manifest_path(config_.output));
    return storage::parse_manifest({std::istreambuf_iterator<char>(stream), {}}, "manifest");
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> owned_ = storage::make_posix_file_system();
  storage::FileSystem& files_ = *owned_;
  execution::NoProgress progress_;
  execution::CancelToken cancel_;
  BuildEnvironment environment_{files_, progress_, cancel_};
  config::Config config_;
};

TEST_F(UpdateTest, AnOutputThatGoesWhileItIsLookedAtIsNotThere) {
  /// Removes a file as soon as it was looked at.
  class Restless final : public storage::ForwardingFiles {
   public:
    using ForwardingFiles::ForwardingFiles;
    storage::FileKind kind(const fs::path& path) override {
      const storage::FileKind found = ForwardingFiles::kind(path);
      if (found == storage::FileKind::regular)
        fs::remove(path);
      return found;
    }
  };
  EXPECT_TRUE(state_of_output(config_, files_).has_value());
  Restless restless(files_);
  EXPECT_FALSE(state_of_output(config_, restless).has_value());
}

TEST_F(UpdateTest, AnotherVersionOfTheProgramIsAReason) {
  EXPECT_EQ(reason(), "");
  storage::Manifest other = manifest();
  other.generator = "meshhier 0.9.0";
  std::ofstream(storage::manifest_path(config_.output)) << to_json_text(other);
  EXPECT_EQ(reason(), "meshhier 0.9.0 made it");
}

TEST_F(UpdateTest, ANoteOfAnotherProgramOrAnOlderOneIsNotTrusted) {
  storage::InputNote changed = storage::read_input_note(*files_.open(note()), "note");
  changed.build["program"] = "meshhier 0.9.0";
  storage::write_input_note(files_, note(), changed);
  EXPECT_THAT(reason(), HasSubstr("program was "));
  changed.build = nullptr;  // as programs wrote it that knew no --update
  storage::write_input_note(files_, note(), changed);
  EXPECT_EQ(reason(), "") << "the mesh is read";
  EXPECT_FALSE(storage::read_input_note(*files_.open(note()), "note").build.is_null());
  changed.content ^= 1;  // another hierarchy's
  storage::write_input_note(files_, note(), changed);
  EXPECT_EQ(reason(), "");
}

TEST_F(UpdateTest, TheReasonNamesWhatDiffers) {
  config_.partition.vertices = 200;
  EXPECT_THAT(reason(), HasSubstr("partition.vertices was 100 and is 200"));
  config_.partition.vertices = 100;
  tests::write_ply(tests::torus(2000), directory_.path() / "mesh.ply");
  EXPECT_EQ(reason(), "mesh.ply is not what it was");
  fs::remove(storage::index_path(config_.output));
  EXPECT_EQ(reason(), "what is there cannot be read");
  fs::remove_all(config_.output);
  EXPECT_EQ(reason(), "it is not there");
}

TEST_F(UpdateTest, AMissingInputIsAnErrorAsInABuild) {
  fs::remove(directory_.path() / "mesh.ply");
  try {
    reason();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
  }
}

}  // namespace
}  // namespace meshhier::pipeline
