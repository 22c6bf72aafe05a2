#include "partition/external_runs.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

namespace meshhier::partition {
namespace {

constexpr std::uint64_t kLeastMemory = 65536;
/// A run is read in blocks of this size: a disk's sequential rate needs about that.
constexpr std::uint64_t kReadBytes = 65536;
/// Grain of the spools: large writes, but small beside the memory.
constexpr std::uint64_t kSpoolBytes = 1 << 20;
/// The first capacity is about this; it doubles as records come.
constexpr std::uint64_t kFirstBytes = 65536;

}  // namespace

ExternalRuns::ExternalRuns(storage::ScratchFile& scratch, std::uint64_t memory_bytes,
                           RecordShape record)
    : buffer_(nullptr, Free{std::align_val_t{record.alignment}}),
      scratch_(scratch),
      memory_(std::max(memory_bytes, kLeastMemory)),
      record_(record) {}

/// Returns how many records are held in memory: all of it but the open blocks of the two spools of
/// a merge.
std::size_t ExternalRuns::limit() const {
  return std::max<std::size_t>(memory_ / 8 * 7 / record_.bytes, 64);
}

/// Returns how many runs one merge takes, a part of the memory being for its output.
std::size_t ExternalRuns::fan_in() const {
  const std::uint64_t read_bytes =
      std::max<std::uint64_t>(std::min(kReadBytes, memory_ / 16), record_.bytes);
  return std::max<std::size_t>(limit() * record_.bytes / read_bytes, 4) - 1;
}

/// Grows the buffer through limit / 2^k: copying into the next one never touches more than the
/// limit.
void ExternalRuns::make_room() {
  assert(!sorted_);
  if (capacity_ == limit())
    return spill_run();
  std::size_t next = limit();
  const std::size_t least = std::max<std::size_t>(kFirstBytes / record_.bytes, 2 * capacity_);
  while (next / 2 >= least && next / 2 > capacity_)
    next /= 2;
  const Free& free = buffer_.get_deleter();
  const std::size_t bytes = next * record_.bytes;
  std::unique_ptr<std::byte[], Free> larger(
      static_cast<std::byte*>(::operator new(bytes, free.alignment)), free);
  if (filled_ > 0)
    std::memcpy(larger.get(), buffer_.get(), filled_ * record_.bytes);
  buffer_ = std::move(larger);
  capacity_ = next;
}

void ExternalRuns::new_spool() {
  const std::uint64_t bytes = std::min(kSpoolBytes, memory_ / 16);
  spools_.push_back(
      std::make_unique<storage::Spool>(scratch_, std::max<std::size_t>(bytes, record_.bytes)));
}

void ExternalRuns::sort_into_output() {
  sort_buffer();
  output_ = {buffer_.get(), filled_ * record_.bytes};
}

void ExternalRuns::spill_run() {
  sort_into_output();
  if (spools_.empty())
    new_spool();
  storage::Spool& spool = *spools_.back();
  const std::uint64_t begin = spool.size() / record_.bytes;
  runs_.push_back({&spool, begin, begin + filled_});
  spool.append(output_);
  spilled_ += filled_;
  filled_ = 0;
}

void ExternalRuns::sort() {
  assert(!sorted_);
  if (runs_.empty()) {
    sort_into_output();
  } else {
    if (filled_ > 0)
      spill_run();
    while (runs_.size() > fan_in())
      reduce_runs();
    start_merge(runs_);
  }
  sorted_ = true;
}

/// Merges the first runs until one merge can take the rest, or once around.
void ExternalRuns::reduce_runs() {
  new_spool();
  storage::Spool& spool = *spools_.back();
  std::vector<Run> reduced;
  std::size_t first = 0, left = runs_.size();
  while (left > fan_in() && first + 1 < runs_.size()) {
    // Merging k runs makes k - 1 fewer: no more than it takes to come down to one merge.
    const std::size_t count = std::min({fan_in(), runs_.size() - first, left - fan_in() + 1});
    const std::uint64_t begin = spool.size() / record_.bytes;
    start_merge(std::span(runs_).subspan(first, count));
    for (std::size_t n = merge_some(); n > 0; n = merge_some()) {
      spool.append(output_.first(n * record_.bytes));
      spilled_ += n;
    }
    reduced.push_back({&spool, begin, spool.size() / record_.bytes});
    first += count;
    left -= count - 1;
  }
  reduced.insert(reduced.end(), runs_.begin() + static_cast<std::ptrdiff_t>(first), runs_.end());
  runs_ = std::move(reduced);
}

/// The buffer becomes one room per run, and the output's.
void ExternalRuns::start_merge(std::span<const Run> runs) {
  const auto count = static_cast<std::uint32_t>(runs.size());
  const std::size_t room = capacity_ / (count + 1) * record_.bytes;
  output_ = {buffer_.get() + count * room, room};
  inputs_.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    inputs_.push_back({runs[i], buffer_.get() + i * room, nullptr, nullptr});
    read_on(inputs_.back());
  }

  // The first round plays all matches from the leaves up, as in a heap: node i's are 2 i, 2 i + 1.
  losers_.assign(count, 0);
  std::vector<std::uint32_t> winners(2 * count);
  for (std::uint32_t i = 0; i < count; ++i)
    winners[count + i] = i;
  for (std::uint32_t node = count - 1; node > 0; --node) {
    std::uint32_t a = winners[2 * node], b = winners[2 * node + 1];
    if (beats(b, a))
      std::swap(a, b);
    winners[node] = a;
    losers_[node] = b;
  }
  losers_[0] = winners[1];
}

void ExternalRuns::read_on(Input& input) const {
  const std::uint64_t count =
      std::min<std::uint64_t>(output_.size() / record_.bytes, input.rest.size());
  const std::size_t bytes = count * record_.bytes;
  if (count > 0)
    input.rest.spool->read(input.rest.begin * record_.bytes, {input.room, bytes});
  input.rest.begin += count;
  input.now = input.room;
  input.end = input.room + bytes;
}

}  // namespace meshhier::partition
