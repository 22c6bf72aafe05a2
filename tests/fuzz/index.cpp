#include "storage/format/index.h"

#include "fuzz/sealed.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "storage/format/tile_glb.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace meshhier::tests::fuzz {
namespace {

void check_record(const TileRecord& record, const Tree& tree) {
  require(tree.contains(record.node) && !tree.is_early(record.node), "a tile of the tree");
  require(record.own_count >= 1 && record.own_count <= storage::kMaxOwnVertices, "own vertices");
  require(record.boundary_count <= record.own_count, "the boundary is of the own");
  require(record.drawn_border_count <= record.border_count, "what is drawn is there");
  require(record.split_count <= most_splits(record.interior_count, record.border_count), "splits");
  require((record.image_width == 0) == (record.image_height == 0), "a picture has two sides");
  require(std::max(record.image_width, record.image_height) <= kMaxImageSide, "a small picture");
  require(record.texel >= 0 && (record.texel == 0 || record.image_width > 0), "its texels");
  require(!record.bounds.empty(), "a box");
}

void decode(Bytes bytes, const Tree& tree) {
  std::vector<TileRecord> records;
  const auto read = [&] { records = storage::decode_index(bytes, tree, "tiles.bin"); };
  if (!refusal({ErrorCode::corrupt}, "tiles.bin: ", read).empty())
    return;
  require(records.size() == tree.tile_count(), "every tile");
  for (const TileRecord& record : records)
    check_record(record, tree);
  require(std::ranges::equal(storage::encode_index(records), bytes), "nothing is lost");
}

}  // namespace

void index(Bytes input) {
  Take take(input);
  const Tree tree = take_tree(take);
  decode(take.rest(), tree);
  decode(sealed_index(take.rest()), tree);
}

}  // namespace meshhier::tests::fuzz
