#include "progressive/stream_index.h"

#include "fuzz/sealed.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "progressive/reconstruct.h"
#include "progressive/reconstruction.h"
#include "support/memory_files.h"

#include <string>

namespace meshhier::tests::fuzz {
namespace {

using progressive::ProgressiveIndex;

/// A stream of which nothing else is there.
void check_stream(const std::string& text) {
  MemoryFiles files;
  files.put("a.prog/progressive.json", text);
  execution::NoProgress progress;
  const std::string refused = refusal({ErrorCode::io, ErrorCode::budget}, "", [&] {
    progressive::reconstruct(files, "a.prog", {{}, "a.ply", std::uint64_t{1} << 20}, progress,
                             execution::CancelToken());
  });
  require(!refused.empty(), "no base, no mesh");
  require(!files.exists("a.ply"), "nothing is written");
}

void check_stream_index(const ProgressiveIndex& index, const std::string& text) {
  const std::string written = to_json_text(index);
  const ProgressiveIndex again = progressive::parse_progressive_index(written, "again");
  require(to_json_text(again) == written, "what is written is read again");
  require(!index.files.empty(), "a base");
  require(index.own_vertices <= index.vertices, "own vertices are some of all");
  const std::uint64_t bytes = progressive::Reconstruction::memory_bytes(
      {index.vertices, index.own_vertices, index.triangles}, index.source.attributes);
  require(bytes / sizeof(std::uint32_t) >= index.triangles, "the arrays' size is no lie");
  check_stream(text);
}

void parse_stream_index(const std::string& text) {
  ProgressiveIndex index;
  const auto read = [&] { index = progressive::parse_progressive_index(text, "progressive.json"); };
  if (refusal({ErrorCode::corrupt}, "progressive.json: ", read).empty())
    check_stream_index(index, text);
}

}  // namespace

void stream_index(Bytes input) {
  const std::string text(text_of(input));
  const std::string repaired = sealed_manifest(text);
  parse_stream_index(repaired);
  if (repaired != text)
    parse_stream_index(text);
}

}  // namespace meshhier::tests::fuzz
