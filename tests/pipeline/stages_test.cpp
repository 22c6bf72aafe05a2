// The table of stages is whole, and true to what builds do.
#include "pipeline/stages.h"

#include "base/error.h"
#include "pipeline/build.h"
#include "pipeline/estimate.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"
#include "storage/io/journal.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using testing::Contains;
using Names = std::set<std::string>;

TEST(StagesTest, EveryTaskIsOfAKindAndEveryKindDoesSomething) {
  Names kinds, named;
  for (const TaskKind& kind : task_kinds())
    EXPECT_TRUE(kinds.emplace(kind.name).second) << kind.name;
  for (const Stage& stage : stages()) {
    for (const TaskPart& part : stage.tasks) {
      if (!part.task.empty())
        named.emplace(part.task);
    }
  }
  EXPECT_EQ(named, kinds);
}

/// Levels of a tree share the time of their stage among them.
TEST(StagesTest, TasksTakeTheTimeOfTheirStage) {
  std::map<std::string_view, TaskCut> cuts;
  for (const TaskKind& kind : task_kinds())
    cuts[kind.name] = kind.cut;
  for (const Stage& stage : stages()) {
    double all = 0;
    for (const TaskPart& part : stage.tasks)
      all += part.task.empty() || cuts[part.task] == TaskCut::top ? 0 : part.time;
    EXPECT_EQ(all, stage.time != nullptr ? 1 : all) << stage.name;
  }
}

/// Asks the build to stop when all is made, and keeps the stages' names.
class Stopper final : public execution::Progress {
 public:
  void stage(std::string_view name, std::uint64_t, std::string_view unit) override {
    told_.emplace(std::string(name) + ' ' + std::string(unit));
    if (name == "sync")
      cancel_.cancel();
  }
  void advance(std::uint64_t) override {}
  void finish(std::string_view) override {}

  const execution::CancelToken& cancel() const { return cancel_; }
  const Names& told() const { return told_; }

 private:
  execution::CancelToken cancel_;
  Names told_;  ///< with their units
};

class BuiltStagesTest : public testing::Test {
 protected:
  BuiltStagesTest() {
    config_.input = directory_.path() / "mesh.ply";
    config_.output = directory_.path() / "mesh.hier";
    config_.threads = 2;
    config_.partition.vertices = 500;
    config_.storage.normals = config::Normals::map;
    config_.normal_map.texels = 64;
    tests::write_ply(tests::sphere(8000), config_.input.front());
    job_ = estimate_build(config_, false, *files_).plan.job;
    EXPECT_THROW(build_hierarchy(config_, {}, {*files_, stopper_, stopper_.cancel()}), Error);
  }

  /// First keys of the journal's entries.
  Names noted() {
    Names keys;
    storage::ScratchUse use;
    const storage::Journal journal(*files_,
                                   storage::journal_path(storage::work_path(config_.output)), use,
                                   [&](const storage::EntrySink::Entry& entry) {
                                     keys.insert(entry.items().begin().key());
                                     return true;
                                   });
    return keys;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  config::Config config_;
  JobSize job_;
  Stopper stopper_;
};

TEST_F(BuiltStagesTest, TheJournalNotesWhatTheRowsSay) {
  Names told{"build", "complete"};
  for (const Stage* stage : stages_of(job_)) {
    for (const std::string_view note : stage->notes) {
      if (!note.empty())
        told.emplace(note);
    }
  }
  EXPECT_EQ(noted(), told);
}

TEST_F(BuiltStagesTest, ProgressTellsWhatWasExpected) {
  const TilePopulation tiles = expected_tiles(job_);
  for (const Stage* stage : stages_of(job_)) {
    for (const auto times : {stage->time, stage->disk_time}) {
      if (times == nullptr)
        continue;
      for (const StageTime& pass : times(job_, tiles)) {
        EXPECT_EQ(pass.name, stage->name);
        EXPECT_THAT(stopper_.told(), Contains(pass.name + ' ' + pass.unit));
      }
    }
  }
}

}  // namespace
}  // namespace meshhier::pipeline
