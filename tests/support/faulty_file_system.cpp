#include "tests/support/faulty_file_system.h"

#include "base/error.h"

#include <algorithm>
#include <string>
#include <utility>

namespace meshhier::tests {
namespace {

[[noreturn]] void fail_io(const char* action, const std::filesystem::path& path,
                          const char* cause) {
  throw Error(ErrorCode::io, std::string("cannot ") + action + " " + path.string() + ": " + cause);
}

const char* name_of(Call call) {
  static constexpr std::array<const char*, kCallKinds> kNames{
      "open",    "create",    "inspect", "read",    "write", "sync",    "make the directory",
      "remove",  "rename to", "sync",    "inspect", "open",  "look at", "lock",
      "look at", "list",      "use"};
  return kNames[static_cast<std::size_t>(call)];
}

class FaultyFile final : public storage::File {
 public:
  FaultyFile(std::unique_ptr<storage::File> real, std::shared_ptr<FaultPlan> plan,
             std::shared_ptr<storage::IoCounters> counters)
      : File(real->path()),
        real_(std::move(real)),
        plan_(std::move(plan)),
        counters_(std::move(counters)) {}

  std::uint64_t size() const override {
    strike(Call::size);
    return real_->size();
  }

  void sync() override { strike(Call::sync); }

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    strike(Call::read);
    const std::size_t count = real_->read_at(offset, bytes.first(plan_->transfer(bytes.size())));
    counters_->bytes_read += count;
    return count;
  }

  std::size_t write_some(std::uint64_t offset, std::span<const std::byte> bytes) override {
    strike(Call::write);
    const std::size_t count = plan_->claim(plan_->transfer(bytes.size()));
    if (count == 0)
      fail_io("write", path(), "no space left on device");
    real_->write_at(offset, bytes.first(count));
    counters_->bytes_written += count;
    return count;
  }

 private:
  void strike(Call call) const {
    if (plan_->strike(call))
      fail_io(name_of(call), path(), "injected");
  }

  std::unique_ptr<storage::File> real_;
  std::shared_ptr<FaultPlan> plan_;
  std::shared_ptr<storage::IoCounters> counters_;
};

}  // namespace

bool FaultPlan::strike(Call call) {
  const std::lock_guard lock(mutex_);
  bool fails = false;
  for (const Call counted : {call, Call::any}) {
    Fault& fault = faults_[static_cast<std::size_t>(counted)];
    ++fault.calls;
    fails = fails || (fault.first <= fault.calls && fault.calls <= fault.last);
  }
  return fails;
}

std::size_t FaultPlan::transfer(std::size_t asked) const {
  const std::lock_guard lock(mutex_);
  return std::min(asked, most_moved_);
}

std::size_t FaultPlan::claim(std::size_t asked) {
  const std::lock_guard lock(mutex_);
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(asked, room_));
  if (room_ != std::numeric_limits<std::uint64_t>::max())
    room_ -= count;
  return count;
}

void FaultyFileSystem::fail(Call call, std::uint64_t n, std::uint64_t times) {
  const std::lock_guard lock(plan_->mutex_);
  FaultPlan::Fault& fault = plan_->faults_[static_cast<std::size_t>(call)];
  fault.first = fault.calls + n;
  fault.last = fault.first + times - 1;
}

void FaultyFileSystem::limit_transfers(std::size_t most_bytes) {
  const std::lock_guard lock(plan_->mutex_);
  plan_->most_moved_ = most_bytes;
}

void FaultyFileSystem::limit_room(std::uint64_t bytes) {
  const std::lock_guard lock(plan_->mutex_);
  plan_->room_ = bytes;
}

void FaultyFileSystem::limit_writes(std::uint64_t bytes) {
  const std::lock_guard lock(plan_->mutex_);
  plan_->room_ = bytes;
  plan_->room_is_told_ = false;
}

std::uint64_t FaultyFileSystem::calls(Call call) const {
  const std::lock_guard lock(plan_->mutex_);
  return plan_->faults_[static_cast<std::size_t>(call)].calls;
}

void FaultyFileSystem::strike(Call call, const std::filesystem::path& path) {
  if (plan_->strike(call))
    fail_io(name_of(call), path, "injected");
}

std::unique_ptr<storage::File> FaultyFileSystem::open(const std::filesystem::path& path) {
  strike(Call::open, path);
  return std::make_unique<FaultyFile>(real_->open(path), plan_, counters_);
}

std::unique_ptr<storage::File> FaultyFileSystem::create(const std::filesystem::path& path) {
  strike(Call::create, path);
  return std::make_unique<FaultyFile>(real_->create(path), plan_, counters_);
}

std::unique_ptr<storage::File> FaultyFileSystem::reopen(const std::filesystem::path& path) {
  strike(Call::reopen, path);
  return std::make_unique<FaultyFile>(real_->reopen(path), plan_, counters_);
}

storage::FileIdentity FaultyFileSystem::identity(const std::filesystem::path& path) {
  strike(Call::identity, path);
  return real_->identity(path);
}

std::unique_ptr<storage::FileLock> FaultyFileSystem::try_lock(const std::filesystem::path& path) {
  strike(Call::lock, path);
  return real_->try_lock(path);
}

bool FaultyFileSystem::is_locked(const std::filesystem::path& path) {
  return real_->is_locked(path);
}

bool FaultyFileSystem::exists(const std::filesystem::path& path) {
  strike(Call::exists, path);
  return real_->exists(path);
}

std::unique_ptr<storage::File> FaultyFileSystem::open_stream(const std::filesystem::path& path,
                                                             const std::function<void()>& check) {
  strike(Call::open, path);
  return std::make_unique<FaultyFile>(real_->open_stream(path, check), plan_, counters_);
}

bool FaultyFileSystem::is_link(const std::filesystem::path& path) {
  return real_->is_link(path);
}

storage::FileKind FaultyFileSystem::kind(const std::filesystem::path& path) {
  return real_->kind(path);
}

std::filesystem::path FaultyFileSystem::canonical(const std::filesystem::path& path) {
  return real_->canonical(path);
}

std::vector<std::filesystem::path> FaultyFileSystem::list(const std::filesystem::path& directory) {
  strike(Call::list, directory);
  return real_->list(directory);
}

std::vector<std::filesystem::path> FaultyFileSystem::children(
    const std::filesystem::path& directory) {
  strike(Call::list, directory);
  return real_->children(directory);
}

void FaultyFileSystem::make_directories(const std::filesystem::path& path) {
  strike(Call::make_directories, path);
  real_->make_directories(path);
}

void FaultyFileSystem::remove_all(const std::filesystem::path& path) {
  strike(Call::remove_all, path);
  real_->remove_all(path);
}

void FaultyFileSystem::remove_if_empty(const std::filesystem::path& directory) {
  strike(Call::remove_all, directory);
  real_->remove_if_empty(directory);
}

void FaultyFileSystem::rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  strike(Call::rename, to);
  real_->rename(from, to);
}

bool FaultyFileSystem::rename_new(const std::filesystem::path& from,
                                  const std::filesystem::path& to) {
  strike(Call::rename, to);
  return real_->rename_new(from, to);
}

bool FaultyFileSystem::exchange(const std::filesystem::path& a, const std::filesystem::path& b) {
  strike(Call::rename, b);
  return can_exchange_ && real_->exchange(a, b);
}

void FaultyFileSystem::sync_directory(const std::filesystem::path& directory) {
  strike(Call::sync_tree, directory);
}

void FaultyFileSystem::sync_tree(const std::filesystem::path& directory) {
  strike(Call::sync_tree, directory);
}

std::uint64_t FaultyFileSystem::free_bytes(const std::filesystem::path& directory) {
  strike(Call::free_bytes, directory);
  const std::uint64_t free = real_->free_bytes(directory);
  const std::lock_guard lock(plan_->mutex_);
  return plan_->room_is_told_ ? std::min(free, plan_->room_) : free;
}

}  // namespace meshhier::tests
