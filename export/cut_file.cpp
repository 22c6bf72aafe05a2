#include "export/cut_file.h"

#include "base/error.h"
#include "base/number_text.h"
#include "base/plain_text.h"
#include "base/text_mark.h"
#include "base/trimmed.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::exporting {
namespace {

constexpr std::string_view kBlanks = " \t\r";

NodeId parse_node(std::string_view text, const std::string& place) {
  const std::size_t slash = text.find('/');
  if (slash != std::string_view::npos) {
    const auto level = parse_number<std::uint8_t>(trimmed(text.substr(0, slash), kBlanks));
    const auto index = parse_number<std::uint32_t>(trimmed(text.substr(slash + 1), kBlanks));
    if (level && index)
      return {static_cast<Level>(*level), *index};
  }
  constexpr std::size_t kShown = 40;  // enough to recognise the entry; the file may be binary
  throw Error(ErrorCode::usage,
              fmt::format("{}: expected a node as level/index, such as 3/5; found \"{}\"", place,
                          plain_text(text, kShown)));
}

std::vector<NodeId> parse_json_nodes(std::string_view text, const std::string& name) {
  const auto shallow = [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    return depth < 2;  // a list of strings needs no more; deeper values are dropped and then missed
  };
  const auto list = storage::parse_json_text(text, shallow, {.throws = false});
  if (!list.is_array()) {
    throw Error(ErrorCode::usage,
                name + ": expected a JSON array of strings such as [\"1/0\", \"2/2\"]");
  }
  std::vector<NodeId> nodes;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string place = fmt::format("{}: entry {}", name, i + 1);
    if (!list[i].is_string()) {
      throw Error(ErrorCode::usage,
                  place + ": expected a node as a string \"level/index\", such as \"3/5\"");
    }
    nodes.push_back(parse_node(trimmed(list[i].get_ref<const std::string&>(), kBlanks), place));
  }
  return nodes;
}

}  // namespace

std::vector<NodeId> parse_nodes(std::string_view text, const std::string& name) {
  text = without_mark(text);
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  if (start != std::string_view::npos && text[start] == '[')
    return parse_json_nodes(text, name);
  std::vector<NodeId> nodes;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view whole = text.substr(0, end);
    const std::string_view content = trimmed(whole.substr(0, whole.find('#')), kBlanks);
    if (!content.empty())
      nodes.push_back(parse_node(content, fmt::format("{}: line {}", name, line)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return nodes;
}

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

}  // namespace meshhier::exporting
