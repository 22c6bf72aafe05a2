#include "partition/object_census.h"

namespace meshhier::partition {

void ObjectCensus::end() {
  parts_.sort();
  move_on(0);
}

ObjectExtent ObjectCensus::take(std::uint32_t object) {
  ObjectExtent extent;
  std::vector<bool> is_shown(shown_.size());
  for (; next() == object; move_on(1)) {
    const ObjectPart& part = block_[0];
    for (std::uint32_t level = part.first_level; level <= part.level; ++level)
      is_shown[level] = true;
    if (part.level + 1 != shown_.size())
      continue;
    if (!extent.box)
      extent.box.emplace();
    extent.box->add(part.box);
    extent.triangles += part.triangles;
    extent.area += part.area;
  }
  for (std::size_t level = 0; level < shown_.size(); ++level)
    shown_[level] += is_shown[level] ? 1 : 0;
  return extent;
}

std::optional<std::uint32_t> ObjectCensus::next() const {
  return block_.empty() ? std::nullopt : std::optional(block_[0].object);
}

void ObjectCensus::move_on(std::size_t count) {
  block_ = block_.subspan(count);
  if (block_.empty())
    block_ = parts_.next_block();
}

}  // namespace meshhier::partition
