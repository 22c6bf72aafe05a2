#include "pipeline/cut_file.h"

#include "hierarchy/error.h"

#include <string_view>
#include <utility>

namespace meshhier::pipeline {

Cut read_cut(storage::FileSystem& files, const Tree& tree, const std::filesystem::path& path) {
  // A list of all partitions of the largest hierarchy has fewer bytes; refuses a wrong file early.
  constexpr std::uint64_t kMaxCutFileBytes = std::uint64_t{64} << 20;
  const auto bytes = storage::read_file(files, path, kMaxCutFileBytes);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  auto nodes = parse_nodes(text, path.string());
  try {
    return {tree, std::move(nodes)};
  } catch (const Error& error) {
    throw error.within(path.string());
  }
}

}  // namespace meshhier::pipeline
