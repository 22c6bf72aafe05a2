#include "pipeline/picture_levels.h"

#include "execution/parallel.h"
#include "images/formats.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::pipeline {
namespace {

std::vector<NodeId> nodes_left(const Tree& tree, Level level, const Share& share,
                               const BuildJournal& journal) {
  const std::uint32_t count = tree.node_count(level);
  std::vector<NodeId> left;
  for (std::uint64_t i = share.begin(count); i < share.end(count); ++i) {
    const NodeId node{level, static_cast<std::uint32_t>(i)};
    if (!tree.is_early(node) && !journal.has_texture(node))
      left.push_back(node);
  }
  return left;
}

/// Ends the processes that encode and decode pictures, as their memory is the next stage's.
struct EndOfCoders {
  EndOfCoders() = default;
  EndOfCoders(const EndOfCoders&) = delete;
  EndOfCoders& operator=(const EndOfCoders&) = delete;
  ~EndOfCoders() { images::end_coders(); }
};

}  // namespace

void make_level_by_level(const char* name, const LevelRange& levels, TextureStore& textures,
                         BuildJournal& journal, const StageContext& context,
                         const std::function<void(NodeId node)>& make) {
  std::vector<std::vector<NodeId>> left;  // from levels.top on
  std::uint64_t total = 0;
  for (int l = levels.top; l < levels.end; ++l) {
    left.push_back(nodes_left(context.tree(), static_cast<Level>(l), levels.share, journal));
    total += left.back().size();
  }
  context.progress.stage(name, total, "tiles");
  const EndOfCoders end;
  textures.set_cache_bytes(picture_cache_bytes(context.memory().work_bytes));
  for (auto nodes = left.rbegin(); nodes != left.rend(); ++nodes) {
    execution::ordered_for(
        nodes->size(), context.plan.threads + 1, context.cancel,
        [&](std::size_t i) {
          make((*nodes)[i]);
          return (*nodes)[i];
        },
        [&](std::size_t, NodeId node) {
          journal.note_texture(node);
          context.progress.advance(1);
        });
  }
}

}  // namespace meshhier::pipeline
