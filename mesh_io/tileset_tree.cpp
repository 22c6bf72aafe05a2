#include "mesh_io/tileset_tree.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "mesh_io/gltf_uri.h"
#include "mesh_io/implicit_tiles.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/part_of_file.h"
#include "mesh_io/tileset.h"
#include "mesh_io/tileset_archive.h"
#include "storage/io/zip_files.h"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostDocuments = 64;  ///< each within the one before
constexpr std::size_t kLongestContent = 255;
/// Counts beyond are told as more than it.
constexpr std::uint64_t kMostCounted = 1'000'000'000'000'000'000;

bool adds(Refine refine, bool parent_adds) {
  return refine == Refine::inherited ? parent_adds : refine == Refine::add;
}

bool is_shown(const TilesetTile& tile, bool is_added) {
  return is_added || tile.is_leaf;
}

/// Returns bytes, unpacked if they are gzip. Reads just so far that too many are noticed.
std::vector<std::byte> unpacked_bytes(const fs::path& path, std::vector<std::byte> bytes) {
  const auto file =
      file_of_bytes(path, std::make_shared<const std::vector<std::byte>>(std::move(bytes)));
  const auto stream = open_stream({*file, file->size()}, {});
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  std::vector<std::byte> content;
  for (std::size_t got = kBlock; got == kBlock && content.size() <= kMostTileData;) {
    const std::size_t size = content.size();
    content.resize(size + kBlock);
    got = stream->read(std::span(content).subspan(size));
    content.resize(size + got);
  }
  return content;
}

/// Returns the folder below which all files lie: that of the document, or of its archive.
fs::path place_of_document(storage::FileSystem& files, const fs::path& path) {
  return storage::archive_around(files, path).value_or(path).parent_path().lexically_normal();
}

}  // namespace

TilesetTree::TilesetTree(storage::FileSystem& files, const fs::path& path, const TilesetRoom& room)
    : files_(files), place_(place_of_document(files, path)), room_(room) {
  add_document(*files_.open(path));
  known_.emplace(path.lexically_normal(), static_cast<std::uint32_t>(contents_.size()));
  contents_.push_back({.file = path, .tile = {.is_tileset = true}, .document = 0});
  const std::uint64_t tiles = size_of(0, false, 0).tiles;
  if (tiles <= room_.tiles)
    return;
  room_.refuse(path,
               fmt::format("is a tileset of {}{} tiles, as its {} name each other; up to {} are "
                           "read",
                           tiles == kMostCounted ? "more than " : "", tiles,
                           counted(documents_.size(), "documents"), room_.tiles));
}

std::uint32_t TilesetTree::add_document(const storage::File& file) {
  Part part{read_tileset_document(file, room_.json_bytes), {}};
  add_implicit_tiles(part.document);
  read_ += std::max(part.document.tiles.size(), part.document.contents.size());
  if (read_ > room_.tiles)
    room_.refuse(file.path(),
                 fmt::format("and the tilesets before it have more than {} tiles", room_.tiles));
  part.contents.resize(part.document.contents.size());
  documents_.push_back(std::move(part));
  return static_cast<std::uint32_t>(documents_.size() - 1);
}

void TilesetTree::add_implicit_tiles(TilesetDocument& document) {
  expand_implicit_tiles(
      document, room_,
      [&](const fs::path& folder, const std::string& uri, const std::string& place) {
        external_.push_back(file_of(document.path, folder, uri, place));
        return files_.open(external_.back());
      });
}

/// Counts the tiles that a document shows with all that it names. They depend on the document and
/// on whether the tile above adds: each of the two is counted once, however often it is named, so
/// documents that name each other take no exponential time.
TilesetTree::Size TilesetTree::size_of(std::uint32_t document, bool parent_adds,
                                       std::size_t level) {
  const fs::path path = documents_[document].document.path;
  const auto [known, is_new] = sizes_.try_emplace({document, parent_adds});
  if (!is_new && known->second.is_open)
    fail_file(path, "is a tileset that holds itself");
  if (level + std::max<std::size_t>(known->second.levels, 1) > kMostDocuments)
    fail_file(path,
              fmt::format("tilesets lie in each other deeper than {} levels", kMostDocuments));
  if (!is_new)
    return known->second;
  Size size{.levels = 1};
  std::vector<bool> added;
  for (std::uint32_t i = 0; i < documents_[document].document.tiles.size(); ++i) {
    const TilesetTile tile = documents_[document].document.tiles[i];  // they may move
    added.push_back(adds(tile.refine, tile.parent ? added[*tile.parent] : parent_adds));
    ++size.tiles;
    for (std::uint32_t c = tile.first_content; c < tile.end_content; ++c) {
      const std::uint64_t with_tile = c == tile.first_content ? 1 : 0;  // counted already
      if (!is_shown(tile, added[i])) {
        size.tiles = std::min(size.tiles + 1 - with_tile, kMostCounted);
        continue;
      }
      const TileContent& content = contents_[content_of(document, c)];
      const std::uint64_t meshes = std::max<std::uint64_t>(content.tile.meshes.size(), 1);
      const Size more = content.document ? size_of(*content.document, added[i], level + 1)
                                         : Size{.tiles = meshes - with_tile};
      size.tiles = std::min(size.tiles + more.tiles, kMostCounted);
      size.levels = std::max(size.levels, more.levels + 1);
    }
  }
  size.is_open = false;
  return sizes_[{document, parent_adds}] = size;
}

std::uint32_t TilesetTree::content_of(std::uint32_t document, std::uint32_t number) {
  if (const auto known = documents_[document].contents[number])
    return *known;
  const Part& part = documents_[document];
  const TileContentName& name = part.document.contents[number];
  if (!name.uri)
    fail_file(part.document.path, place_of(part.document, name) + " has no \"uri\"");
  std::uint32_t found = 0;
  if (name.uri->starts_with("data:")) {
    const auto base64 = base64_of(*name.uri);
    if (!base64)
      fail_file(part.document.path,
                place_of(part.document, name) + " is a data URI that is no base64");
    TileContent content = data_content(part, name, *base64);
    const auto file = file_of_bytes(content.file, content.data);
    found = add_content(std::move(content), *file);
  } else {
    fs::path path = file_of(part.document.path, part.document.path.parent_path(), *name.uri,
                            place_of(part.document, name));
    if (is_tileset_archive(files_, path))
      path = tileset_of_archive(files_, path);
    const auto known = known_.find(path);
    found = known != known_.end() ? known->second
                                  : add_content({.file = path, .tile = {}}, *files_.open(path));
    known_.emplace(path, found);
  }
  documents_[document].contents[number] = found;
  return found;
}

/// `file`: its bytes.
std::uint32_t TilesetTree::add_content(TileContent content, const storage::File& file) {
  content.tile = read_tile_file(file, room_.json_bytes);
  if (content.tile.is_tileset) {
    if (!content.data)
      external_.push_back(content.file);
    content.document = add_document(file);
  }
  contents_.push_back(std::move(content));
  return static_cast<std::uint32_t>(contents_.size() - 1);
}

TileContent TilesetTree::data_content(const Part& part, const TileContentName& name,
                                      std::string_view base64) {
  std::vector<std::byte> bytes;
  const bool is_sound = decode_base64(base64, [&](std::span<const std::byte> piece) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
  });
  if (!is_sound)
    fail_file(part.document.path, place_of(part.document, name) + ": its data URI is no base64");
  bytes = unpacked_bytes(part.document.path, std::move(bytes));
  data_bytes_ += bytes.size();
  if (data_bytes_ > kMostTileData)
    fail_file(part.document.path,
              fmt::format("{}: tiles of more than {} bytes are data URIs; write them as files",
                          place_of(part.document, name), kMostTileData));
  return {.file = part.document.path,
          .data = std::make_shared<const std::vector<std::byte>>(std::move(bytes)),
          .tile = {}};
}

fs::path TilesetTree::file_of(const fs::path& document, const fs::path& folder,
                              const std::string& uri, const std::string& place) const {
  const std::string shown = plain_text(uri, kLongestContent);
  const auto fail = [&](const std::string& message) { fail_file(document, place + " " + message); };
  if (uri.find("://") != std::string::npos || uri.starts_with("//"))
    fail("is on the web (" + shown + "); fetch the whole tileset first");
  if (auto found = find_file(folder, uri))
    return *std::move(found);
  // Archives name each other as if their files lay beside them.
  if (const auto archive = storage::archive_around(files_, folder / "")) {
    if (auto found = find_file(archive->parent_path() / folder.lexically_relative(*archive), uri))
      return *std::move(found);
  }
  fail(fmt::format("is {}, which is no file below the folder of the tileset", shown));
  return {};
}

std::optional<fs::path> TilesetTree::find_file(const fs::path& folder,
                                               const std::string& uri) const {
  for (std::string name : names_of_uri(uri)) {
    for (int i = 0; i < 2; ++i) {
      fs::path path = (folder / name).lexically_normal();
      if (is_below_place(path) && files_.kind(path) == storage::FileKind::regular)
        return path;
      name.resize(std::min(name.find_first_of("?#"), name.size()));  // as a server would
    }
  }
  return std::nullopt;
}

bool TilesetTree::is_below_place(const fs::path& path) const {
  const fs::path relative = path.lexically_relative(place_.empty() ? fs::path(".") : place_);
  return !relative.empty() && *relative.begin() != "..";
}

TilesetTree::Stand TilesetTree::stand_of(const TilesetDocument& document, const TilesetTile& tile,
                                         const Stand& parent,
                                         const std::optional<GlobeFrame>& frame) {
  Stand stand{.to_globe = parent.to_globe * tile.transform,
              .placement = parent.placement * tile.transform,
              .adds = mesh_io::adds(tile.refine, parent.adds)};
  // Exactly, without a way to the globe and back:
  if (frame && !tile.parent && parent.to_globe * from_input(document) == frame->to_globe)
    stand.placement = document.origin;
  else if (frame && stand.to_globe == frame->to_globe)
    stand.placement = {};
  return stand;
}

void TilesetTree::walk(std::uint32_t document, const Stand& parent,
                       const std::optional<GlobeFrame>& frame, const Visit& visit,
                       const std::function<void()>& coarser) const {
  const Part& part = documents_[document];
  std::vector<Stand> stands;
  stands.reserve(part.document.tiles.size());
  for (const TilesetTile& tile : part.document.tiles) {
    stands.push_back(
        stand_of(part.document, tile, tile.parent ? stands[*tile.parent] : parent, frame));
    const Stand& stand = stands.back();
    for (std::uint32_t c = tile.first_content; c < tile.end_content; ++c) {
      if (!is_shown(tile, stand.adds)) {
        coarser();
        continue;
      }
      const TileContent& content = contents_[part.contents[c].value()];
      if (content.document)
        walk(*content.document, stand, frame, visit, coarser);
      else
        visit({content, tile, part.document.axes, stand.to_globe, stand.placement});
    }
  }
}

void TilesetTree::for_each(const std::optional<GlobeFrame>& frame, const Visit& visit,
                           const std::function<void()>& coarser) const {
  walk(0, {{}, to_frame(frame), false}, frame, visit, coarser);
}

}  // namespace meshhier::mesh_io
