#include "storage/format/manifest.h"

#include "fuzz/sealed.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "hierarchy/tree.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/index.h"
#include "support/memory_files.h"

#include <string>

namespace meshhier::tests::fuzz {
namespace {

using storage::Manifest;

/// A reader of the directory gets by with the tree and refuses the index, which is not there or
/// empty.
void check_reader(const std::string& text) {
  for (const bool has_index : {false, true}) {
    MemoryFiles files;
    files.put("a.hier/hierarchy.json", text);
    if (has_index)
      files.put("a.hier/tiles.bin", "");
    const std::string refused = refusal({has_index ? ErrorCode::corrupt : ErrorCode::io}, "",
                                        [&] { storage::HierarchyReader reader(files, "a.hier"); });
    require(!refused.empty(), "no index, no hierarchy");
  }
}

void check_manifest(const Manifest& manifest, const std::string& text) {
  const std::string written = storage::to_json_text(manifest);
  const Manifest again = storage::parse_manifest(written, "again");
  require(storage::to_json_text(again) == written, "what is written is read again");
  const Tree tree(manifest.source.places, manifest.partition_count);
  require(tree.tile_count() < std::uint64_t{1} << 33, "the counts make a tree");
  check_reader(text);
}

void parse(const std::string& text) {
  Manifest manifest;
  const auto read = [&] { manifest = storage::parse_manifest(text, "hierarchy.json"); };
  if (refusal({ErrorCode::corrupt}, "hierarchy.json: ", read).empty())
    check_manifest(manifest, text);
}

}  // namespace

void manifest(Bytes input) {
  const std::string text(text_of(input));
  const std::string repaired = sealed_manifest(text);
  parse(repaired);
  if (repaired != text)
    parse(text);
}

}  // namespace meshhier::tests::fuzz
