// A table of properties beside a mesh whose objects have names, or are labels.
//
// First a byte: which mesh it is.
#include "fuzz/import_reading.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "import/import_input.h"

#include <string>

namespace meshhier::tests::fuzz {
namespace {

constexpr const char* kNamed =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\no a\nf 1 2 3\no 7\nf 2 4 3\no b c\nf 1 2 4\n";
constexpr const char* kLabelled =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 3\nproperty list uchar int vertex_indices\nproperty int bone\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 3\n3 0 2 3 10\n3 0 1 3 -7\n";

}  // namespace

void records(Bytes input) {
  Take take(input);
  const bool is_labelled = take.upto<std::uint8_t>(1) != 0;
  MemoryFiles files;
  files.put("mesh", is_labelled ? kLabelled : kNamed);
  files.put("table", text_of(take.rest()));
  importing::InputUse use;
  if (is_labelled)
    use.objects = {mesh_io::ObjectSource::label, "bone"};
  use.object_table = "table";
  std::string first, table;
  const std::string message = refusal({ErrorCode::input}, "", [&] {
    first = imported(files, use);
    table = files.content("objects");
  });
  if (!message.empty())
    return;
  require(imported(files, use) == first, "the same once more");
  require(files.content("objects") == table, "the same table once more");
}

}  // namespace meshhier::tests::fuzz
