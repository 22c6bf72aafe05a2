#include "inspection/page_file.h"

#include "hierarchy/error.h"
#include "hierarchy/plain_text.h"
#include "inspection/byte_stream.h"
#include "storage/format/archive_files.h"
#include "storage/format/build_name.h"
#include "storage/format/gzip.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/io/output_file.h"
#include "storage/io/paths.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <queue>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::inspection {
namespace {

namespace fs = std::filesystem;

/// Where the viewer's page takes the hierarchy.
constexpr std::string_view kMark = "<!-- meshhier: hierarchy -->";
constexpr std::string_view kTitle = "<title>meshhier</title>";
/// Records of the index that the viewer fetches at once (viewer/src/hierarchy/tile_index.ts).
constexpr std::uint64_t kPageRecords = 545;

/// RFC 4648, section 4.
std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (k < count ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= count ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string escaped(std::string_view text) {
  std::string made;
  for (const char c : text) {
    switch (c) {
      case '&':
        made += "&amp;";
        break;
      case '<':
        made += "&lt;";
        break;
      case '>':
        made += "&gt;";
        break;
      default:
        made += c;
    }
  }
  return made;
}

/// As JSON in a script element: no "<" can end it.
std::string json_text(const std::string& text) {
  std::string json =
      nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;)
    json.replace(at, 1, "\\u003c");
  return json;
}

/// What lies beside a hierarchy; empty: nothing does. Throws Error(io), and Error(corrupt) if it is
/// no JSON object.
std::string story_of(storage::FileSystem& files, const fs::path& hierarchy) {
  constexpr int kDeepest = 32;
  const fs::path path = storage::story_path(storage::without_last_slash(hierarchy));
  if (files.kind(path) != storage::FileKind::regular)
    return {};
  const auto bytes = storage::read_file(*files.open(path), storage::kMostStoryBytes);
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto shallow = [](int depth, auto, const auto&) { return depth < kDeepest; };
  const auto story = nlohmann::json::parse(text, shallow, /*allow_exceptions=*/false);
  if (!story.is_object())
    throw Error(ErrorCode::corrupt, path.string() + ": it is no JSON object");
  return text;
}

std::vector<std::byte> packed(std::vector<std::byte> bytes) {
  std::vector<std::byte> smaller = storage::gzip(bytes);
  return smaller.size() < bytes.size() ? smaller : bytes;
}

/// A file as it stands in the page.
std::string entry_of(const fs::path& name, std::vector<std::byte> bytes) {
  return fmt::format(",\n\"{}\":\"{}\"", name.generic_string(), base64(packed(std::move(bytes))));
}

/// The viewer's page around the hierarchy.
struct Frame {
  std::string before, behind;
};

Frame frame_of(const std::string& viewer, const std::string& story, const PageOptions& options) {
  const std::size_t mark = viewer.find(kMark);
  if (mark == std::string::npos)
    throw Error(ErrorCode::io,
                "the viewer's single.html is not that of this program: build it again");
  Frame frame{viewer.substr(0, mark), viewer.substr(mark + kMark.size())};
  if (const std::size_t title = frame.before.find(kTitle); title != std::string::npos)
    frame.before.replace(title, kTitle.size(), "<title>" + escaped(options.name) + "</title>");
  frame.before += "<script type=\"application/json\" id=\"meshhier-hierarchy\">\n{\"name\":" +
                  json_text(options.name);
  if (!options.link.empty())
    frame.before += ",\"link\":" + json_text(options.link);
  if (!story.empty())
    frame.before += ",\"story\":" + json_text(story);
  frame.before += ",\"files\":{";
  frame.behind = "}}\n</script>" + frame.behind;
  return frame;
}

class PageWriter {
 public:
  PageWriter(storage::FileSystem& files, const storage::HierarchyReader& reader, ByteStream& out,
             std::uint64_t room)
      : files_(files), reader_(reader), out_(out), room_(room) {}

  /// False if it does not fit.
  bool add(const std::vector<std::string>& entries, std::uint64_t index_bytes) {
    std::uint64_t bytes = 0;
    for (const std::string& entry : entries)
      bytes += entry.size();
    const std::uint64_t index = (index_bytes + 2) / 3 * 4 + 100;
    if (used_ + bytes + index > room_)
      return false;
    for (const std::string& entry : entries)
      put(entry);
    return true;
  }
  /// Whatever it takes: it was reserved.
  void put(const std::string& entry) {
    const auto text = std::string_view(entry).substr(is_first_ ? 1 : 0);  // without its comma
    out_.put(text);
    is_first_ = false;
    used_ += text.size();
  }
  std::uint64_t used() const { return used_; }
  std::string entry(const fs::path& name) const {
    return storage::of_one_build(files_, reader_.directory(), reader_.manifest(), [&] {
      const auto file = files_.open(reader_.directory() / name);
      return entry_of(name, storage::read_file(*file, kMostFile));
    });
  }

 private:
  /// Of a tile or another file of a hierarchy.
  static constexpr std::uint64_t kMostFile = std::uint64_t{1} << 32;

  storage::FileSystem& files_;
  const storage::HierarchyReader& reader_;
  ByteStream& out_;
  std::uint64_t room_;
  std::uint64_t used_ = 0;
  bool is_first_ = true;
};

/// A tile that may be refined, the one with the largest error first.
struct Coarse {
  float error = 0;
  NodeId node;
  friend bool operator<(const Coarse& a, const Coarse& b) {
    return a.error != b.error ? a.error < b.error : b.node < a.node;
  }
};

std::uint64_t number_of(const storage::HierarchyReader& reader, NodeId tile) {
  const auto& records = reader.records();
  return static_cast<std::uint64_t>(&storage::record_of(records, tile) - records.data());
}

/// Of the index up to the page that has a record.
std::uint64_t index_bytes_with(const storage::HierarchyReader& reader, std::uint64_t record) {
  const std::uint64_t records = (record / kPageRecords + 1) * kPageRecords;
  return std::min(storage::index_bytes(records), reader.manifest().index_bytes);
}

struct Chosen {
  std::uint64_t tiles = 0;
  std::uint64_t last_record = 0;
  float error = 0;  ///< the largest of what is not refined
};

/// Behind the root.
Chosen add_tiles(const storage::HierarchyReader& reader, PageWriter& page,
                 execution::Progress& progress, const execution::CancelToken& cancel) {
  const Tree& tree = reader.tree();
  Chosen chosen{1, 0, 0};
  std::priority_queue<Coarse> coarse;
  coarse.push({reader.record(tree.root()).error, tree.root()});
  while (!coarse.empty()) {
    cancel.check();
    const Coarse next = coarse.top();
    std::vector<std::string> entries;
    std::vector<NodeId> children;
    std::uint64_t last = chosen.last_record;
    const Tree::Children below = tree.children(next.node);
    for (const NodeId child : below.span()) {
      const NodeId tile = tree.tile_node(child);
      children.push_back(tile);
      entries.push_back(page.entry(storage::tile_path({}, tile)));
      last = std::max(last, number_of(reader, tile));
    }
    if (!page.add(entries, index_bytes_with(reader, last)))
      break;
    coarse.pop();
    chosen.last_record = last;
    chosen.tiles += children.size();
    for (const NodeId tile : children) {
      if (!tree.is_partition(tile))
        coarse.push({reader.record(tile).error, tile});
    }
    progress.advance(children.size());
  }
  chosen.error = coarse.empty() ? 0 : coarse.top().error;
  return chosen;
}

}  // namespace

std::string write_page(storage::FileSystem& files, const fs::path& hierarchy,
                       const std::string& viewer, const PageOptions& options,
                       execution::Progress& progress, const execution::CancelToken& cancel) {
  const storage::HierarchyFiles place(files, hierarchy);
  const storage::HierarchyReader reader(place.files(), hierarchy);
  const std::string story = options.looks_for_story ? story_of(files, hierarchy) : std::string();
  const Frame frame = frame_of(viewer, story, options);
  storage::OutputFile output(files, {options.output, options.replace, {hierarchy}},
                             [&] { cancel.check(); });
  ByteStream out(*output.file());
  const std::uint64_t around = frame.before.size() + frame.behind.size();
  PageWriter page(place.files(), reader, out, options.size > around ? options.size - around : 0);
  progress.stage("page", reader.records().size(), "tiles");
  out.put(frame.before);
  const fs::path root = storage::tile_path({}, reader.tree().root());
  const std::vector<std::string> first{page.entry(storage::manifest_path({})), page.entry(root)};
  const std::uint64_t least_index = index_bytes_with(reader, 0);
  if (!page.add(first, least_index)) {
    const std::uint64_t least = around + first[0].size() + first[1].size() + 2 * least_index;
    throw Error(ErrorCode::usage,
                fmt::format("a page of {} bytes has no room for the viewer and the "
                            "root: give --size {} or more",
                            options.size, least));
  }
  page.add({page.entry(storage::outline_path({}))}, least_index);
  const Chosen chosen = add_tiles(reader, page, progress, cancel);
  auto index = storage::read_file(*place.files().open(storage::index_path(hierarchy)),
                                  reader.manifest().index_bytes);
  index.resize(index_bytes_with(reader, chosen.last_record));
  page.put(entry_of(storage::index_path({}), std::move(index)));
  storage::require_same_build(place.files(), hierarchy, reader.manifest());
  out.put(frame.behind);
  out.flush();
  const std::uint64_t bytes = around + page.used();
  output.publish();
  return fmt::format(
      "{}: {} of {}, {} bytes; {}", options.output.string(), chosen.tiles,
      counted(reader.records().size(), "tiles"), bytes,
      chosen.error == 0
          ? "all of the mesh"
          : fmt::format("errors up to {:.3g} in the units of the input", chosen.error));
}

}  // namespace meshhier::inspection
