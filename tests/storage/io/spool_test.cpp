#include "storage/io/spool.h"

#include "base/error.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/pattern.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

using tests::Call;
using tests::FaultyFileSystem;
using tests::pattern;
using Bytes = std::vector<std::byte>;

Bytes content(const Spool& spool) {
  Bytes bytes(spool.size());
  spool.read(0, bytes);
  return bytes;
}

void append_in_steps(Spool& spool, const Bytes& bytes, std::size_t step) {
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    spool.append(std::span(bytes).subspan(at, std::min(step, bytes.size() - at)));
  }
}

class SpoolTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("spool_") + info.name() + std::to_string(::getpid()));
    std::filesystem::remove(path_);
    for (int i = 1; i < 16; ++i)
      std::filesystem::remove(path_.string() + "." + std::to_string(i));
  }

  FaultyFileSystem files_;
  std::filesystem::path path_;
};

TEST_F(SpoolTest, PlacesOfClearedSpoolsAreUsedAgain) {
  MemoryPool pool(0);
  ScratchFile scratch(files_, path_, pool);
  Spool kept(scratch, 100), other(scratch, 70);
  {
    Spool cleared(scratch, 100);
    for (std::size_t i = 0; i < 3; ++i) {
      cleared.append(pattern(200));
      kept.append(pattern(100, i));
    }
    other.append(pattern(141));
  }
  const std::uint64_t size = scratch.size();
  Spool next(scratch, 100);
  next.append(pattern(501, 9));
  EXPECT_EQ(scratch.size(), size) << "five blocks were free";
  next.append(pattern(200, 8));
  EXPECT_EQ(scratch.size(), size + 200) << "two more were closed";
  EXPECT_EQ(pool.scratch_use().peak_bytes_on_disk(), scratch.size());
  Bytes expected = pattern(501, 9);
  const Bytes more = pattern(200, 8);
  expected.insert(expected.end(), more.begin(), more.end());
  EXPECT_EQ(content(next), expected);
  Bytes kept_bytes;
  for (std::size_t i = 0; i < 3; ++i) {
    const Bytes part = pattern(100, i);
    kept_bytes.insert(kept_bytes.end(), part.begin(), part.end());
  }
  EXPECT_EQ(content(kept), kept_bytes);
  EXPECT_EQ(content(other), pattern(141));
}

TEST_F(SpoolTest, WhatIsOnDiskIsCountedUntilItsFileIsGone) {
  MemoryPool pool(150);
  const ScratchUse& use = pool.scratch_use();
  {
    ScratchFile scratch(files_, path_, pool);
    Spool spool(scratch, 100);
    spool.append(pattern(350));  // one block in memory, two on disk, one open
    EXPECT_EQ(use.bytes_written(), 200U);
    EXPECT_EQ(use.bytes_on_disk(), 200U);
    EXPECT_EQ(use.bytes_read(), 0U);
    EXPECT_EQ(content(spool), pattern(350));
    EXPECT_EQ(use.bytes_read(), 200U);
    spool.clear();
    EXPECT_EQ(use.bytes_on_disk(), 200U) << "the file has not shrunk";
  }
  EXPECT_EQ(use.bytes_on_disk(), 0U);
  ScratchFile again(files_, path_, pool);
  again.append(pattern(120));
  EXPECT_EQ(use.bytes_on_disk(), 120U);
  EXPECT_EQ(use.peak_bytes_on_disk(), 200U);
  EXPECT_EQ(use.bytes_written(), 320U);
}

TEST_F(SpoolTest, APoolGivesNoMoreThanItHas) {
  MemoryPool pool(100);
  EXPECT_TRUE(pool.try_take(60));
  EXPECT_FALSE(pool.try_take(41));
  EXPECT_TRUE(pool.try_take(40));
  EXPECT_EQ(pool.free_bytes(), 0U);
  EXPECT_TRUE(pool.try_take(0));
  EXPECT_FALSE(pool.try_take(1));
  pool.give_back(30);
  EXPECT_EQ(pool.free_bytes(), 30U);
  EXPECT_TRUE(pool.try_take(30));
}

TEST_F(SpoolTest, APoolGivesNoMoreThanItHasToManyThreads) {
  MemoryPool pool(1000);
  std::atomic<int> taken{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 1000; ++k)
        taken += pool.try_take(3) ? 1 : 0;
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(taken, 333);
  EXPECT_EQ(pool.free_bytes(), 1U);
}

// Content never depends on where it lies.
TEST_F(SpoolTest, ContentIsTheSameForEveryBlockSizeStepAndMemory) {
  const Bytes bytes = pattern(5003);
  for (const std::size_t block : {1U, 7U, 64U, 5003U, 6000U}) {
    for (const std::size_t step : {1U, 64U, 1000U, 5003U}) {
      for (const std::uint64_t memory : {0U, 2000U, 1000000U}) {
        MemoryPool pool(memory);
        ScratchFile scratch(files_, path_, pool);
        Spool spool(scratch, block);
        append_in_steps(spool, bytes, step);
        ASSERT_EQ(spool.size(), bytes.size());
        ASSERT_EQ(content(spool), bytes) << block << " " << step << " " << memory;
      }
    }
  }
}

TEST_F(SpoolTest, AnyPartCanBeReadAnyNumberOfTimes) {
  const Bytes bytes = pattern(500);
  MemoryPool pool(200);  // some blocks in memory, some on disk
  ScratchFile scratch(files_, path_, pool);
  Spool spool(scratch, 64);
  spool.append(bytes);
  for (std::size_t begin = 0; begin <= bytes.size(); begin += 9) {
    for (std::size_t end = begin; end <= bytes.size(); end += 23) {
      Bytes part(end - begin);
      spool.read(begin, part);
      ASSERT_TRUE(
          std::equal(part.begin(), part.end(), bytes.begin() + static_cast<std::ptrdiff_t>(begin)))
          << begin << " " << end;
    }
  }
}

TEST_F(SpoolTest, WhatFitsInMemoryNeverTouchesTheDisk) {
  MemoryPool pool(1000);
  ScratchFile scratch(files_, path_, pool);
  Spool spool(scratch, 100);
  spool.append(pattern(1000));
  EXPECT_EQ(content(spool), pattern(1000));
  EXPECT_EQ(files_.calls(Call::create), 0U);
  EXPECT_EQ(scratch.size(), 0U);
}

TEST_F(SpoolTest, OnlyWhatDoesNotFitGoesToDiskInWholeBlocks) {
  MemoryPool pool(300);
  ScratchFile scratch(files_, path_, pool);
  Spool spool(scratch, 100);
  spool.append(pattern(1050));
  EXPECT_EQ(pool.free_bytes(), 0U);
  EXPECT_EQ(scratch.size(), 700U);  // ten blocks are full, three of them in memory
  EXPECT_EQ(files_.calls(Call::create), 1U);
  EXPECT_EQ(std::filesystem::file_size(path_), 700U);
}

TEST_F(SpoolTest, ClearingGivesTheMemoryBackAndTheSpoolServesAgain) {
  MemoryPool pool(300);
  ScratchFile scratch(files_, path_, pool);
  Spool spool(scratch, 100);
  for (std::size_t round = 0; round < 3; ++round) {
    spool.append(pattern(1050, round));
    EXPECT_EQ(content(spool), pattern(1050, round));
    spool.clear();
    EXPECT_EQ(spool.size(), 0U);
    EXPECT_EQ(pool.free_bytes(), 300U);
  }
}

TEST_F(SpoolTest, ASpoolThatGoesGivesItsMemoryBackOnce) {
  MemoryPool pool(300);
  ScratchFile scratch(files_, path_, pool);
  {
    Spool first(scratch, 100);
    first.append(pattern(250));
    Spool second(std::move(first));
    EXPECT_EQ(content(second), pattern(250));
    EXPECT_EQ(first.size(), 0U);  // NOLINT(bugprone-use-after-move): promised to be empty
    EXPECT_EQ(pool.free_bytes(), 100U);
  }
  EXPECT_EQ(pool.free_bytes(), 300U);
}

TEST_F(SpoolTest, ManySpoolsShareOneFile) {
  MemoryPool pool(0);
  ScratchFile scratch(files_, path_, pool);
  std::vector<Spool> spools;
  for (std::size_t i = 0; i < 20; ++i)
    spools.emplace_back(scratch, 16 + i);
  for (std::size_t round = 0; round < 10; ++round) {
    for (std::size_t i = 0; i < spools.size(); ++i)
      spools[i].append(pattern(50, 1000 * i + 50 * round));
  }
  EXPECT_EQ(files_.calls(Call::create), 1U);
  for (std::size_t i = 0; i < spools.size(); ++i) {
    Bytes expected;
    for (std::size_t round = 0; round < 10; ++round) {
      const Bytes part = pattern(50, 1000 * i + 50 * round);
      expected.insert(expected.end(), part.begin(), part.end());
    }
    EXPECT_EQ(content(spools[i]), expected);
  }
}

TEST_F(SpoolTest, ThreadsFillTheirSpoolsAtOnce) {
  MemoryPool pool(5000);
  ScratchFile scratch(files_, path_, pool);
  std::vector<Spool> spools;
  for (int i = 0; i < 4; ++i)
    spools.emplace_back(scratch, 64);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < spools.size(); ++i) {
    threads.emplace_back([&, i] { append_in_steps(spools[i], pattern(20000, i), 37); });
  }
  for (std::thread& thread : threads)
    thread.join();
  for (std::size_t i = 0; i < spools.size(); ++i)
    EXPECT_EQ(content(spools[i]), pattern(20000, i));
}

/// The files of a scratch file, of which there may be several.
std::size_t files_of(const std::filesystem::path& path) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(path.parent_path())) {
    const std::string name = entry.path().filename().string();
    const std::string first = path.filename().string();
    count += name == first || name.starts_with(first + ".") ? 1 : 0;
  }
  return count;
}

TEST_F(SpoolTest, ThreadsWriteToFilesOfTheirOwn) {
  MemoryPool pool(0);
  {
    ScratchFile scratch(files_, path_, pool, ScratchFile::Stays::no,
                        ScratchFile::Files::one_a_thread);
    constexpr std::size_t kThreads = 6;
    std::vector<Spool> spools;
    for (std::size_t i = 0; i < kThreads; ++i)
      spools.emplace_back(scratch, 64);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < kThreads; ++i)
      threads.emplace_back([&, i] { append_in_steps(spools[i], pattern(10'000, i), 33 + i); });
    for (std::thread& thread : threads)
      thread.join();
    EXPECT_EQ(files_of(path_), kThreads);
    EXPECT_EQ(scratch.size(), kThreads * 9984U) << "the last blocks are open";
    EXPECT_EQ(pool.scratch_use().bytes_on_disk(), scratch.size());
    for (std::size_t i = 0; i < kThreads; ++i)
      EXPECT_EQ(content(spools[i]), pattern(10'000, i));
    for (Spool& spool : spools)
      spool.clear();
    Spool next(scratch, 64);
    next.append(pattern(kThreads * 9984, 9));
    EXPECT_EQ(scratch.size(), kThreads * 9984U) << "places in any of the files are used again";
    EXPECT_EQ(content(next), pattern(kThreads * 9984, 9));
  }
  EXPECT_EQ(files_of(path_), 0U);
  EXPECT_EQ(pool.scratch_use().bytes_on_disk(), 0U);
}

TEST_F(SpoolTest, ALaterProcessGoesOnWithAllFiles) {
  MemoryPool pool(0);
  std::vector<StoredSpool> stored;
  const auto open = [&] {
    return std::make_unique<ScratchFile>(files_, path_, pool, ScratchFile::Stays::yes,
                                         ScratchFile::Files::one_a_thread);
  };
  constexpr std::size_t kThreads = 3;
  {
    const auto scratch = open();
    std::vector<Spool> written;
    for (std::size_t i = 0; i < kThreads; ++i) {
      std::thread([&] {
        Spool& spool = written.emplace_back(*scratch, 100);
        spool.append(pattern(950, i));
        stored.push_back(spool.store());
      }).join();
    }
    scratch->sync([] {});
  }
  ASSERT_EQ(files_of(path_), kThreads);
  const auto scratch = open();
  std::vector<Spool> spools;
  for (std::size_t i = 0; i < kThreads; ++i) {
    Spool& spool = spools.emplace_back(*scratch, 100);
    ASSERT_TRUE(spool.restore(stored[i]));
    ASSERT_TRUE(spool.is_as_stored());
  }
  EXPECT_EQ(scratch->size(), kThreads * 950);
  for (std::size_t i = 0; i < 2 * kThreads; ++i) {
    std::thread([&] {
      Spool more(*scratch, 100);
      more.append(pattern(950, 7));
      EXPECT_EQ(content(more), pattern(950, 7));
    }).join();
  }
  for (std::size_t i = 0; i < kThreads; ++i)
    EXPECT_EQ(content(spools[i]), pattern(950, i)) << "nothing was written over";
  StoredSpool beyond = stored[1];
  beyond.blocks[0] += 1'000'000;
  Spool other(*scratch, 100);
  ASSERT_TRUE(other.restore(beyond));
  EXPECT_FALSE(other.is_as_stored());
  beyond.blocks[0] = stored[1].blocks[0] + (std::uint64_t{9} << 40);
  Spool none(*scratch, 100);
  ASSERT_TRUE(none.restore(beyond));
  EXPECT_FALSE(none.is_as_stored()) << "in a file that is not there";
  scratch->remove();
  EXPECT_EQ(files_of(path_), 0U);
}

TEST_F(SpoolTest, TheScratchFileIsRemovedAtTheEnd) {
  MemoryPool pool(0);
  {
    ScratchFile scratch(files_, path_, pool);
    (void)scratch.append(pattern(10));
    EXPECT_TRUE(std::filesystem::exists(path_));
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(SpoolTest, AScratchFileThatCannotBeRemovedIsNoReasonToDie) {
  MemoryPool pool(0);
  files_.fail(Call::remove_all, 1);
  {
    ScratchFile scratch(files_, path_, pool);
    (void)scratch.append(pattern(10));
  }
  EXPECT_EQ(files_.calls(Call::remove_all), 1U);
}

TEST_F(SpoolTest, AnUnusedScratchFileLeavesNoTrace) {
  MemoryPool pool(0);
  { const ScratchFile scratch(files_, path_, pool); }
  EXPECT_EQ(files_.calls(Call::create), 0U);
  EXPECT_EQ(files_.calls(Call::remove_all), 0U);
}

TEST_F(SpoolTest, AFullDiskReachesTheWriter) {
  MemoryPool pool(0);
  files_.limit_room(1000);
  ScratchFile scratch(files_, path_, pool);
  Spool spool(scratch, 100);
  try {
    append_in_steps(spool, pattern(5000), 50);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
  }
}

TEST_F(SpoolTest, AFailedReadReachesTheReader) {
  MemoryPool pool(0);
  ScratchFile scratch(files_, path_, pool);
  Spool spool(scratch, 100);
  spool.append(pattern(500));
  files_.fail(Call::read, 3);
  EXPECT_THROW((void)content(spool), Error);
  EXPECT_EQ(content(spool), pattern(500));
}

TEST_F(SpoolTest, AFileThatCannotBeMadeCanBeTriedAgain) {
  MemoryPool pool(0);
  ScratchFile scratch(files_, path_, pool);
  Spool spool(scratch, 100);
  spool.append(pattern(100));
  files_.fail(Call::create, 1);
  const Bytes more = pattern(60, 100);
  EXPECT_THROW(spool.append(more), Error);
  EXPECT_EQ(spool.size(), 100U);
  spool.append(more);
  Bytes expected = pattern(100);
  expected.insert(expected.end(), more.begin(), more.end());
  EXPECT_EQ(content(spool), expected);
}

struct Record {
  std::uint32_t key = 0;
  float value = 0;
  friend bool operator==(const Record&, const Record&) = default;
};

TEST_F(SpoolTest, RecordsMayStraddleBlocks) {
  MemoryPool pool(64);
  ScratchFile scratch(files_, path_, pool);
  RecordSpool<Record> spool(scratch, 13);
  std::vector<Record> records(200);
  for (std::uint32_t i = 0; i < records.size(); ++i)
    records[i] = {i * i, static_cast<float>(i) / 7};
  spool.append(std::span<const Record>(records).first(150));
  for (std::size_t i = 150; i < records.size(); ++i)
    spool.append(records[i]);
  EXPECT_EQ(spool.size(), records.size());
  EXPECT_EQ(spool.read_all(), records);
  std::vector<Record> part(20);
  spool.read(140, part);
  EXPECT_TRUE(std::equal(part.begin(), part.end(), records.begin() + 140));
  spool.clear();
  EXPECT_EQ(spool.size(), 0U);
  EXPECT_TRUE(spool.read_all().empty());
}

}  // namespace
}  // namespace meshhier::storage
