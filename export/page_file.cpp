#include "export/page_file.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "export/byte_stream.h"
#include "export/page_tiles.h"
#include "mesh_io/output_name.h"
#include "storage/format/archive_files.h"
#include "storage/format/build_name.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/io/json_text.h"
#include "storage/io/output_file.h"
#include "storage/io/paths.h"
#include "storage/io/sealed_file.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::exporting {
namespace {

namespace fs = std::filesystem;

/// The mark in the viewer's page that the hierarchy replaces.
constexpr std::string_view kMark = "<!-- meshhier: hierarchy -->";
constexpr std::string_view kTitle = "<title>meshhier</title>";
/// Chromium's longest text has 2^29 - 24 characters, and the hierarchy in the page is one.
constexpr std::uint64_t kMostPageBytes = 500'000'000;
/// Bytes that the manifest of a page may have more than the hierarchy's: the lattice, and other
/// numbers.
constexpr std::uint64_t kManifestSlack = 600;

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

/// Returns JSON for a script element: no "<" can end it.
std::string json_text(const std::string& text) {
  std::string json = storage::json_text(nlohmann::json(text));
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;)
    json.replace(at, 1, "\\u003c");
  return json;
}

/// Returns the story beside a hierarchy, with its pictures, which take half of the room that the
/// viewer leaves at the most. Throws Error(io), and Error(corrupt) if it is no JSON object.
PageStory story_of(storage::FileSystem& files, const fs::path& hierarchy,
                   const PageOptions& options, std::uint64_t room) {
  if (!options.looks_for_story)
    return {};
  const fs::path path = storage::story_path(storage::without_last_slash(hierarchy));
  if (files.kind(path) != storage::FileKind::regular)
    return {};
  const auto bytes = storage::read_file(*files.open(path), storage::kMostStoryBytes);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::uint64_t most = std::min(room / 2, storage::kMostStoryBytes - text.size());
  return with_pictures(text, path.string(), most / 4 * 3, options.open_picture);
}

/// The viewer's page around the hierarchy.
struct Frame {
  std::string before, behind;
  std::uint64_t bytes() const { return before.size() + behind.size(); }
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

/// The tiles that are chosen, and their packing.
struct Filling {
  PagePacker packer;
  PageChoice choice;

  /// Returns how far the page is from the original, at the most, besides a rounding of the
  /// hierarchy.
  double error() const { return double{choice.error} + choice.rounding; }
};

/// The sources of a page.
struct PageSource {
  storage::FileSystem& files;
  const storage::HierarchyReader& reader;
  const PageOptions& options;
  execution::Progress& progress;
  const execution::CancelToken& cancel;
};

Filling filled(const PageSource& source, PagePacking packing, std::uint64_t room) {
  PagePacker packer(source.files, source.reader, packing);
  PageChoice choice = choose_tiles(packer, room, source.progress, source.cancel);
  return {packer, std::move(choice)};
}

/// Rounded where not all fits exactly, and the error of what is shown is twice the rounding, or the
/// page is nearer to the original that way. A rounding as large as the error would be seen: it
/// makes steps where simplified surfaces are smooth.
Filling filling_of(const PageSource& source, std::uint64_t room) {
  constexpr double kCover = 2;
  source.progress.stage("choose", 0, "steps");
  if (!source.options.link.empty())
    return filled(source, PagePacking::as_stored, room);
  Filling exact = filled(source, PagePacking::exact, room);
  const bool has_none = exact.choice.tiles.empty();
  const double rounding =
      PagePacker(source.files, source.reader, PagePacking::rounded).most_rounding();
  if (rounding == 0 || (!has_none && kCover * rounding > exact.error()))
    return exact;
  Filling rounded = filled(source, PagePacking::rounded, room);
  const bool is_covered = kCover * rounded.choice.rounding <= double{rounded.choice.error};
  return has_none || is_covered || rounded.error() < exact.error() ? rounded : exact;
}

constexpr std::uint64_t kMostEntry = std::uint64_t{1} << 32;

std::string entry_of(const PageSource& source, const fs::path& name) {
  const auto path = source.reader.directory() / name;
  return page_entry(name, storage::read_file(source.files, path, kMostEntry));
}

/// A file that the page may lack: it is in it unless it takes too much of the room.
struct Besides {
  fs::path name;
  std::string_view missing;  ///< told if it is not
  std::string entry;
  bool is_in = false;
};

/// Reads a file, whose bytes the manifest seals, if it fits: it then leaves less room for all else.
Besides besides(const PageSource& source, const fs::path& name, const storage::Seal& seal,
                std::string_view missing, std::uint64_t& room) {
  constexpr std::uint64_t kPart = 4;  // of the room
  Besides file{name, missing, ""};
  if (seal.bytes <= room) {
    const storage::HierarchyReader& reader = source.reader;
    const auto bytes =
        storage::of_one_build(source.files, reader.directory(), reader.manifest(), [&] {
          return storage::read_sealed(source.files, reader.directory() / name, seal, kMostEntry);
        });
    file.entry = page_entry(name, bytes);
  }
  file.is_in = !file.entry.empty() && file.entry.size() <= room / kPart;
  room -= file.is_in ? file.entry.size() : 0;
  return file;
}

bool is_in(std::span<const Besides> files, const fs::path& name) {
  return std::ranges::any_of(files,
                             [&](const Besides& file) { return file.name == name && file.is_in; });
}

/// The outline shows itself before the first tile, so it is worth a part, but no more. Words lead
/// to objects: without these they are worth nothing.
std::vector<Besides> besides_of(const PageSource& source, std::uint64_t& room) {
  const storage::Manifest& manifest = source.reader.manifest();
  std::vector<Besides> files;
  files.push_back(besides(source, storage::outline_path({}),
                          {manifest.outline_bytes, manifest.outline_checksum},
                          "the shape-outline did not fit\n", room));
  if (!manifest.objects)
    return files;
  const storage::ObjectTableFacts& objects = manifest.objects->table;
  files.push_back(besides(source, storage::objects_path({}), {objects.bytes, objects.checksum},
                          "the names and properties of objects did not fit\n", room));
  if (const auto& words = manifest.objects->words; words && files.back().is_in) {
    files.push_back(besides(source, storage::object_words_path({}), {words->bytes, words->checksum},
                            "the words of objects' names did not fit\n", room));
  }
  return files;
}

/// Returns the bytes of the entries of those that are in.
std::uint64_t entry_bytes(std::span<const Besides> files) {
  std::uint64_t bytes = 0;
  for (const Besides& file : files)
    bytes += file.is_in ? file.entry.size() : 0;
  return bytes;
}

/// Returns lines that tell of the others.
std::string missing_text(std::span<const Besides> files) {
  std::string text;
  for (const Besides& file : files)
    text += file.is_in ? "" : file.missing;
  return text;
}

/// Entries one behind the other, the first one without its comma.
class EntryStream {
 public:
  explicit EntryStream(ByteStream& out) : out_(out) {}
  void put(std::string_view entries) {
    const std::size_t comma = is_first_ && !entries.empty() ? 1 : 0;
    out_.put(entries.substr(comma));
    is_first_ = is_first_ && entries.empty();
    bytes_ += entries.size() - comma;
  }
  std::uint64_t bytes() const { return bytes_; }

 private:
  ByteStream& out_;
  bool is_first_ = true;
  std::uint64_t bytes_ = 0;
};

/// Returns how many bytes were written.
std::uint64_t write_files(const PageSource& source, const Filling& filling,
                          std::span<const Besides> besides, ByteStream& out) {
  const auto& [packer, choice] = filling;
  std::vector<TileRecord> records = source.reader.records();
  EntryStream entries(out);
  for (const Besides& file : besides) {
    if (file.is_in)
      entries.put(file.entry);
  }
  source.progress.stage("page", choice.tiles.size(), "tiles");
  for (const NodeId tile : choice.tiles) {
    source.cancel.check();
    PackedTile packed = packer.pack(tile);
    entries.put(packed.entry);
    records[record_number(source.reader, tile)] = packed.record;
    source.progress.advance(1);
  }
  entries.put(packer.account(std::move(records), choice.last_record, choice.rounding,
                             is_in(besides, storage::object_words_path({}))));
  return entries.bytes();
}

std::string megabytes(std::uint64_t bytes) {
  constexpr std::uint64_t kMegabyte = 1'000'000;
  return fmt::format("{}MB", (bytes + kMegabyte - 1) / kMegabyte);
}

/// Returns a line that says what did not fit, and what would make it fit; or nothing.
std::string left_out_text(const PageSource& source, const Filling& filling,
                          std::uint64_t other_bytes) {
  const std::uint64_t all = source.reader.records().size();
  const std::uint64_t left = all - filling.choice.tiles.size();
  if (left == 0)
    return "";
  const std::string what = counted(left, "tiles");
  if (!source.options.link.empty())
    return fmt::format("{} did not fit: the page fetches them from the link\n", what);
  const std::uint64_t needed =
      other_bytes + expected_page_bytes(filling.packer, filling.choice, source.cancel);
  const std::string cure =
      needed <= kMostPageBytes
          ? fmt::format("about {}: give --size {}, or", megabytes(needed), megabytes(needed))
          : fmt::format("about {}, and browsers hold {} at most: give", megabytes(needed),
                        megabytes(kMostPageBytes));
  return fmt::format(
      "{} did not fit. All of them take {} --link with the address of the whole hierarchy\n", what,
      cure);
}

std::string account_text(const PageSource& source, const Filling& filling, std::uint64_t bytes,
                         std::uint64_t viewer) {
  const double error = filling.error();
  std::string text = fmt::format(
      "{}: {} of {}, {} bytes, of which the viewer takes {}; {}\n", source.options.output.string(),
      filling.choice.tiles.size(), counted(source.reader.records().size(), "tiles"), bytes, viewer,
      error == 0 ? "all of the mesh"
                 : fmt::format("errors up to {:.3g} in the units of the input", error));
  if (filling.choice.rounding > 0)
    text += fmt::format("positions are rounded to {} bits, by {:.3g} at most\n",
                        Lattice::kShortBits, filling.choice.rounding);
  return text;
}

std::string story_text(const PageStory& story, execution::Progress& progress) {
  for (const std::string& line : story.left_out)
    progress.warn("a picture of the story is left out: " + line);
  if (story.pictures == 0 && story.left_out.empty())
    return "";
  return fmt::format("{} of {} of the story\n", story.pictures,
                     counted(story.pictures + story.left_out.size(), "pictures"));
}

/// `needed`: what there must be besides the viewer and the story, whose pictures take half of what
/// there is.
[[noreturn]] void refuse_size(std::uint64_t size, std::uint64_t viewer, const PageStory& story,
                              std::uint64_t needed) {
  const bool has_pictures = story.pictures > 0 || !story.left_out.empty();
  const std::uint64_t least = viewer + (has_pictures ? 2 : 1) * (story.text.size() + needed);
  throw Error(ErrorCode::usage, fmt::format("a page of {} bytes has no room for the viewer and the "
                                            "root: give --size {} or more",
                                            size, least));
}

}  // namespace

std::string write_page(storage::FileSystem& files, const fs::path& hierarchy,
                       const std::string& viewer, const PageOptions& options,
                       execution::Progress& progress, const execution::CancelToken& cancel) {
  mesh_io::require_true_ending(options.output.string(), {".html", ".htm"},
                               "of a hierarchy page makes one HTML file; name it .html");
  const storage::HierarchyFiles place(files, hierarchy);
  const storage::HierarchyReader reader(place.files(), hierarchy);
  const PageSource source{place.files(), reader, options, progress, cancel};
  storage::OutputRequest request{options.output, options.replace, options.inputs};
  request.inputs.push_back(hierarchy);
  if (options.looks_for_story)
    request.inputs.push_back(storage::story_path(storage::without_last_slash(hierarchy)));
  storage::OutputFile output(files, request, [&] { cancel.check(); });
  const std::uint64_t size = std::min(options.size, kMostPageBytes);
  const PageStory story =
      story_of(files, hierarchy, options, size > viewer.size() ? size - viewer.size() : 0);
  const Frame frame = frame_of(viewer, story.text, options);
  const std::uint64_t fixed =
      frame.bytes() + entry_of(source, storage::manifest_path({})).size() + kManifestSlack;
  std::uint64_t room = size > fixed ? size - fixed : 0;
  const std::vector<Besides> besides = besides_of(source, room);
  const Filling filling = filling_of(source, room);
  if (filling.choice.tiles.empty()) {
    const std::uint64_t around = fixed - std::min(fixed, viewer.size() + story.text.size());
    refuse_size(options.size, viewer.size(), story,
                around + entry_of(source, storage::outline_path({})).size() + filling.choice.least);
  }
  ByteStream out(*output.file());
  out.put(frame.before);
  const std::uint64_t bytes = frame.bytes() + write_files(source, filling, besides, out);
  out.put(frame.behind);
  out.flush();
  const std::string left_out = left_out_text(source, filling, fixed + entry_bytes(besides));
  storage::require_same_build(place.files(), hierarchy, reader.manifest());
  output.publish();
  std::string account = account_text(source, filling, bytes, viewer.size()) + left_out +
                        missing_text(besides) + story_text(story, progress);
  account.pop_back();  // the end of the last line
  return account;
}

}  // namespace meshhier::exporting
