#include "progressive/stream_index.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "storage/format/manifest.h"
#include "storage/format/sealed_json.h"
#include "storage/io/sealed_file.h"

#include <utility>

#include <fmt/format.h>

namespace meshhier::progressive {
namespace {

using Json = nlohmann::ordered_json;

constexpr storage::SealedFormat kStreamFormat{"meshhier-progressive", 2,
                                              "make it again from its hierarchy"};

/// No disk holds so many, and the bytes of their array can still be counted in 64 bits.
constexpr std::uint64_t kMostTriangles = std::uint64_t{1} << 56;

/// The most bytes of an entry, one that is alone in its run: the run's head, gzip's frame, all
/// values of a vertex.
constexpr std::uint64_t kMostEntryBytes = 128;

/// A tree over less than 2^32 partitions has no more levels.
constexpr std::uint64_t kDeepestLevel = 32;

Json file_json(const ProgressiveFile& file, std::uint32_t step) {
  return {{"file", storage::detail_path({}, step).string()},
          {"level", raw(file.level)},
          {"vertices", file.vertices},
          {"triangles", file.triangles},
          {"merges", file.merges},
          {"shown_vertices", file.shown_vertices},
          {"shown_triangles", file.shown_triangles},
          {"bytes", file.bytes},
          {"checksum", storage::hex_digits(file.checksum)}};
}

ProgressiveFile read_entry(const storage::JsonObject& object, const ProgressiveIndex& index) {
  ProgressiveFile file;
  file.level = static_cast<Level>(object.count("level", kDeepestLevel));
  file.vertices = object.count("vertices", index.vertices);
  file.triangles = object.count("triangles", index.triangles);
  file.merges = object.count("merges", index.vertices);
  file.shown_vertices = object.count("shown_vertices", index.vertices);
  file.shown_triangles = object.count("shown_triangles", index.triangles);
  const std::uint64_t entries = file.vertices + file.triangles + file.merges;
  file.bytes = object.count("bytes", (entries + 1) * kMostEntryBytes);
  file.checksum = object.hash("checksum");
  return file;
}

}  // namespace

std::string to_json_text(const ProgressiveIndex& index) {
  Json document;
  document["generator"] = index.generator;
  document["source"] = storage::source_json(index.source);
  document["level"] = raw(index.node.level);
  document["index"] = index.node.index;
  document["vertices"] = index.vertices;
  document["own_vertices"] = index.own_vertices;
  document["triangles"] = index.triangles;
  document["origin"] = storage::point_json(index.origin);
  document["up"] = name_of(index.up);
  document["licence"] = index.licence;
  Json files = Json::array();
  for (const ProgressiveFile& file : index.files)
    files.push_back(file_json(file, static_cast<std::uint32_t>(files.size())));
  document["files"] = std::move(files);
  return storage::sealed_text(kStreamFormat, document);
}

ProgressiveIndex parse_progressive_index(const std::string& text, const std::string& name) {
  const Json document = storage::parse_sealed(text, kStreamFormat, name);
  const storage::JsonObject object(document, "", name);
  ProgressiveIndex index;
  index.generator = object.text("generator");
  index.source = storage::parse_source(object.at("source"), name);
  index.node.level = static_cast<Level>(object.count("level", kDeepestLevel));
  index.node.index = object.short_count("index");
  index.vertices = object.count("vertices", UINT32_MAX);
  if (index.vertices == 0)
    object.wrong("vertices", "at least 1");
  index.own_vertices = object.count("own_vertices", index.vertices);
  index.triangles = object.count("triangles", kMostTriangles);
  index.origin = object.point("origin");
  index.up = object.up("up");
  index.licence = object.text("licence");
  for (const storage::JsonObject& file : object.objects("files"))
    index.files.push_back(read_entry(file, index));
  if (index.files.empty())
    object.wrong("files", "at least one");
  return index;
}

ProgressiveIndex read_progressive_index(storage::FileSystem& files,
                                        const std::filesystem::path& directory) {
  const auto path = storage::progressive_index_path(directory);
  return parse_progressive_index(storage::read_sealed_text(*files.open(path)), path.string());
}

std::vector<std::byte> read_detail_file(storage::FileSystem& files,
                                        const std::filesystem::path& directory,
                                        const ProgressiveIndex& index, std::uint32_t step) {
  const ProgressiveFile& file = index.files.at(step);
  return read_sealed(files, storage::detail_path(directory, step), {file.bytes, file.checksum},
                     UINT64_MAX);
}

}  // namespace meshhier::progressive
