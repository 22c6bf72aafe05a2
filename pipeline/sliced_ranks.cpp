#include "pipeline/sliced_ranks.h"

#include "base/error.h"
#include "pipeline/tiles/blob_json.h"

#include <algorithm>
#include <cstring>

namespace meshhier::pipeline {

nlohmann::json SlicedRanks::store(const Share& slice, std::span<const std::uint32_t> counts) const {
  nlohmann::json blocks = nlohmann::json::array();
  for (std::uint64_t i = slice.begin(blobs_.count()); i < slice.end(blobs_.count()); ++i)
    blocks.push_back(to_json(blobs_.stored(i)));
  return {{"counts", counts}, {"blocks", std::move(blocks)}};
}

bool SlicedRanks::restore(const Share& slice, const nlohmann::json& stored) {
  const nlohmann::json& blocks = stored.at("blocks");
  const std::uint64_t first = slice.begin(blobs_.count());
  if (slice.index + 1 != before_.size() || blocks.size() != slice.end(blobs_.count()) - first)
    return false;
  std::uint64_t block = first;
  for (const nlohmann::json& blob : blocks) {
    if (!pipeline::restore(blobs_, block, blob))
      return false;
    const std::uint64_t bytes = blobs_.size(block++);
    if (bytes % sizeof(std::uint32_t) != 0)
      return false;
    vertices_.push_back(vertices_.back() + bytes / sizeof(std::uint32_t));
    slices_.push_back(slice.index);
  }
  return add_counts(stored.at("counts"));
}

bool SlicedRanks::add_counts(const nlohmann::json& counts) {
  if (counts.size() != map_->count())
    return false;
  std::vector<std::uint32_t> sums = before_.back();
  for (std::uint32_t chunk = 0; chunk < map_->count(); ++chunk) {
    const std::uint32_t count = counts.at(chunk);
    if (count > map_->size(chunk) - sums[chunk])
      return false;
    sums[chunk] += count;
  }
  before_.push_back(std::move(sums));
  return true;
}

bool SlicedRanks::is_whole() const {
  for (std::uint32_t chunk = 0; chunk < map_->count(); ++chunk) {
    if (before_.back()[chunk] != map_->size(chunk))
      return false;
  }
  return vertices_.back() == vertex_count_;
}

IdRange SlicedRanks::ids_of(const Share& slice) const {
  return {vertices_[slice.begin(blobs_.count())], vertices_[slice.end(blobs_.count())]};
}

void SlicedRanks::read(std::uint64_t id, std::span<std::uint32_t> ranks) const {
  if (id + ranks.size() > vertex_count_)
    throw Error(ErrorCode::corrupt,
                "a vertex of a slice is none of this mesh: plan the build again");
  auto block = static_cast<std::size_t>(std::upper_bound(vertices_.begin(), vertices_.end(), id) -
                                        vertices_.begin() - 1);
  for (; !ranks.empty(); ++block) {
    const storage::BlobView view = blobs_.view(block);
    const std::uint64_t skipped = id - vertices_[block];
    const std::uint64_t count =
        std::min<std::uint64_t>(ranks.size(), vertices_[block + 1] - vertices_[block] - skipped);
    std::memcpy(ranks.data(), view.bytes().data() + skipped * sizeof(std::uint32_t),
                count * sizeof(std::uint32_t));
    correct(slices_[block], ranks.first(count));
    ranks = ranks.subspan(count);
    id += count;
  }
}

void SlicedRanks::correct(std::uint32_t slice, std::span<std::uint32_t> ranks) const {
  const std::vector<std::uint32_t>& before = before_[slice];
  // A rank was given as if its slice were the first: the places of the slices before, in the same
  // chunk, come in front. Nobody vouches for what other tasks wrote, so all is checked.
  const std::uint32_t last = map_->count() - 1;
  const std::uint64_t places = std::uint64_t{map_->first_rank(last)} + map_->size(last);
  const bool has_copies = places < vertex_count_;
  partition::ChunkFinder finder(*map_);
  for (std::uint32_t& rank : ranks) {
    if (rank == kCopy && has_copies)
      continue;
    const std::uint32_t chunk = rank < places ? finder.chunk_of(rank) : 0;
    const std::uint64_t place = std::uint64_t{rank} - map_->first_rank(chunk) + before[chunk];
    if (place >= map_->size(chunk)) {
      throw Error(ErrorCode::corrupt,
                  "the ranks of a slice are not those of this mesh: plan the build again");
    }
    rank = map_->first_rank(chunk) + static_cast<std::uint32_t>(place);
  }
}

}  // namespace meshhier::pipeline
