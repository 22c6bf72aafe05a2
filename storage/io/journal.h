// The journal of a long job: entry after entry, it says what is done, in a file that outlives the
// job's process.
//
// clang-format off
//   offset  bytes
//   0       8      "meshjrn" and the version, 1
//   then, for each entry:
//   0       4      n, bytes of the entry, little endian
//   4       8      XXH3-64 of the entry, seeded with that of the entry before (0 for the first), little endian
//   12      n      the entry, CBOR
// clang-format on
//
// An entry counts if it and all before it are whole. An entry that was half written when the
// process was killed does not count, nor do those whose predecessor was in a page that never
// reached the disk. So nothing has to be forced to the disk in any order.
#pragma once

#include "storage/io/file.h"
#include "storage/io/scratch_use.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include <nlohmann/json.hpp>

namespace meshhier::storage {

/// Takes entries that say what of a job is done. One thread at a time may use it.
class EntrySink {
 public:
  using Entry = nlohmann::json;

  EntrySink() = default;
  EntrySink(const EntrySink&) = delete;
  EntrySink& operator=(const EntrySink&) = delete;
  virtual ~EntrySink() = default;

  /// Appends an entry. Throws Error(io); nothing is appended then.
  virtual void append(const Entry& entry) = 0;
  /// Forces all entries to the disk. Throws Error(io).
  virtual void sync() = 0;
};

class Journal final : public EntrySink {
 public:
  /// Opens the journal at `path`; begins one if there is none. `take` gets the entries that count,
  /// in order, until it returns false: that entry and all behind it are dropped. Bytes that are
  /// moved are counted in `use`. Throws Error(io). `use` must outlive it.
  Journal(FileSystem& files, const std::filesystem::path& path, ScratchUse& use,
          const std::function<bool(const Entry&)>& take);

  void append(const Entry& entry) override;
  void sync() override { file_->sync(); }

 private:
  void read(const std::function<bool(const Entry&)>& take);
  bool read_all(std::uint64_t offset, std::span<std::byte> bytes);
  void write(std::span<const std::byte> bytes);

  ScratchUse& use_;
  std::unique_ptr<File> file_;
  std::uint64_t end_ = 0;
  std::uint64_t last_checksum_ = 0;
};

}  // namespace meshhier::storage
