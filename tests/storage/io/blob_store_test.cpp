#include "storage/io/blob_store.h"

#include "base/error.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/pattern.h"

#include <algorithm>
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

std::vector<std::byte> content(const BlobStore& store, std::size_t index) {
  const BlobView view = store.view(index);
  return {view.bytes().begin(), view.bytes().end()};
}

class BlobStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("blobs_") + info.name() + std::to_string(::getpid()));
    std::filesystem::remove(path_);
  }

  FaultyFileSystem files_;
  std::filesystem::path path_;
};

TEST_F(BlobStoreTest, BlobsComeBackWhateverTheMemory) {
  for (const std::uint64_t memory : {0U, 700U, 100000U}) {
    MemoryPool pool(memory);
    ScratchFile scratch(files_, path_, pool);
    BlobStore store(scratch, 50);
    EXPECT_EQ(store.count(), 50U);
    for (std::size_t i = 50; i-- > 0;)
      store.put(i, pattern(i * 3, i));
    for (std::size_t i = 0; i < 50; ++i) {
      EXPECT_EQ(store.size(i), i * 3);
      EXPECT_EQ(content(store, i), pattern(i * 3, i)) << memory << " " << i;
      EXPECT_EQ(content(store, i), pattern(i * 3, i)) << memory << " " << i;
    }
  }
}

TEST_F(BlobStoreTest, ABlobNeverPutIsEmpty) {
  MemoryPool pool(10);
  ScratchFile scratch(files_, path_, pool);
  const BlobStore store(scratch, 3);
  EXPECT_EQ(store.size(1), 0U);
  EXPECT_TRUE(store.view(1).bytes().empty());
}

TEST_F(BlobStoreTest, PartsAreRead) {
  for (const std::uint64_t memory : {0U, 1000U}) {
    MemoryPool pool(memory);
    ScratchFile scratch(files_, path_, pool);
    BlobStore store(scratch, 2);
    store.put(0, pattern(100, 0));
    store.put(1, pattern(300, 1));
    const Bytes whole = pattern(300, 1);
    for (std::size_t offset = 0; offset <= 300; offset += 17) {
      Bytes part(std::min<std::size_t>(40, 300 - offset));
      store.read(1, offset, part);
      EXPECT_TRUE(std::equal(part.begin(), part.end(),
                             whole.begin() + static_cast<std::ptrdiff_t>(offset)));
    }
  }
}

TEST_F(BlobStoreTest, AllIsOnDiskAndWhatFitsInMemoryToo) {
  MemoryPool pool(250);
  ScratchFile scratch(files_, path_, pool);
  BlobStore store(scratch, 4);
  store.put(0, pattern(200, 0));
  EXPECT_EQ(pool.free_bytes(), 50U);
  store.put(1, pattern(100, 1));  // does not fit any more
  EXPECT_EQ(pool.free_bytes(), 50U);
  store.put(2, pattern(50, 2));  // fits what is left
  EXPECT_EQ(pool.free_bytes(), 0U);
  EXPECT_EQ(scratch.size(), 350U);
  const std::uint64_t reads = files_.calls(Call::read);
  store.view(0);
  store.view(2);
  EXPECT_EQ(files_.calls(Call::read), reads);
  store.view(1);
  EXPECT_GT(files_.calls(Call::read), reads);
  store.drop_copies();
  EXPECT_EQ(pool.free_bytes(), 250U);
  EXPECT_EQ(content(store, 0), pattern(200, 0));
}

TEST_F(BlobStoreTest, AnotherProcessGoesOn) {
  MemoryPool pool(0);
  std::vector<StoredBlob> stored;
  {
    ScratchFile scratch(files_, path_, pool, ScratchFile::Stays::yes);
    BlobStore store(scratch, 3);
    store.put(2, pattern(100, 2));
    store.put(0, pattern(50, 0));
    for (std::size_t i = 0; i < 3; ++i)
      stored.push_back(store.stored(i));
  }
  ScratchFile scratch(files_, path_, pool, ScratchFile::Stays::yes);
  BlobStore store(scratch, 3);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(store.restore(i, stored[i])) << i;
  store.put(1, pattern(70, 1));
  for (const auto& [index, bytes] : {std::pair(0, 50), std::pair(1, 70), std::pair(2, 100)}) {
    const BlobView view = store.view(index);
    EXPECT_TRUE(std::ranges::equal(view.bytes(), pattern(bytes, index))) << index;
  }
}

TEST_F(BlobStoreTest, WhatTheDiskChangedIsNotRestoredNorRead) {
  MemoryPool pool(0);
  ScratchFile scratch(files_, path_, pool, ScratchFile::Stays::yes);
  BlobStore store(scratch, 2);
  store.put(0, pattern(100, 0));
  const StoredBlob stored = store.stored(0);
  files_.reopen(path_)->write_at(40, pattern(1, 99));
  EXPECT_FALSE(BlobStore(scratch, 2).restore(0, stored));
  EXPECT_FALSE(BlobStore(scratch, 2).restore(0, {stored.offset + 1, stored.bytes, stored.checksum}))
      << "beyond the end";
  EXPECT_THROW(store.view(0), Error);
}

TEST_F(BlobStoreTest, ClearingGivesTheMemoryBackAndTheBlobsCanBePutAgain) {
  MemoryPool pool(250);
  ScratchFile scratch(files_, path_, pool);
  BlobStore store(scratch, 3);
  for (std::size_t round = 0; round < 3; ++round) {
    for (std::size_t i = 0; i < 3; ++i)
      store.put(i, pattern(100, i + round));
    EXPECT_EQ(pool.free_bytes(), 50U);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(content(store, i), pattern(100, i + round));
    store.clear();
    EXPECT_EQ(pool.free_bytes(), 250U);
    EXPECT_EQ(store.size(0), 0U);
    EXPECT_EQ(store.count(), 3U);
  }
}

TEST_F(BlobStoreTest, MovingMovesTheMemoryToo) {
  MemoryPool pool(250);
  ScratchFile scratch(files_, path_, pool);
  {
    BlobStore store(scratch, 1);
    store.put(0, pattern(100, 0));
    const BlobStore moved(std::move(store));
    EXPECT_EQ(content(moved, 0), pattern(100, 0));
    EXPECT_EQ(pool.free_bytes(), 150U);
  }
  EXPECT_EQ(pool.free_bytes(), 250U);
}

TEST_F(BlobStoreTest, ThreadsPutAndReadDifferentBlobsAtOnce) {
  MemoryPool pool(20000);
  ScratchFile scratch(files_, path_, pool);
  BlobStore store(scratch, 400);
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (std::size_t i = t; i < 400; i += 4) {
        store.put(i, pattern(i, i));
        wrong += content(store, i) == pattern(i, i) ? 0 : 1;
      }
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(wrong, 0);
  for (std::size_t i = 0; i < 400; ++i)
    EXPECT_EQ(content(store, i), pattern(i, i));
}

TEST_F(BlobStoreTest, FailuresReachTheCaller) {
  MemoryPool pool(0);
  ScratchFile scratch(files_, path_, pool);
  BlobStore store(scratch, 3);
  files_.fail(Call::create, 1);
  EXPECT_THROW(store.put(0, pattern(10, 0)), Error);
  files_.fail(Call::write, 1);
  EXPECT_THROW(store.put(1, pattern(10, 1)), Error);
  store.put(2, pattern(10, 2));
  files_.fail(Call::read, 1);
  EXPECT_THROW((void)store.view(2), Error);
  EXPECT_EQ(content(store, 2), pattern(10, 2));
}

}  // namespace
}  // namespace meshhier::storage
