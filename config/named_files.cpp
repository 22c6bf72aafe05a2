#include "config/named_files.h"

#include "base/error.h"
#include "base/text_mark.h"
#include "config/input_frame.h"
#include "mesh_io/formats.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_folder.h"
#include "mesh_io/other_formats.h"
#include "storage/format/layout.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::config {
namespace {

namespace fs = std::filesystem;

/// Returns the first bytes behind blanks and the mark of UTF-8.
std::string first_bytes(const storage::File& file) {
  constexpr std::size_t kLookedAt = 1024;
  std::string start(kLookedAt, '\0');
  start.resize(file.read_at(0, std::as_writable_bytes(std::span(start))));
  start = without_mark(start);
  return start.erase(0, std::min(start.find_first_not_of(" \t\r\n"), start.size()));
}

bool begins_as_config(std::string_view text) {
  return text.starts_with('{') || text.starts_with("//") || text.starts_with("/*");
}

/// Throws if the file is known to be something else.
void refuse_foreign(const fs::path& path, const std::string& start) {
  if (const std::string found = mesh_io::other_format(start); !found.empty()) {
    throw Error(ErrorCode::usage,
                fmt::format("{}: expected a mesh ({}) or a config (JSON), found {}", path.string(),
                            mesh_io::format_names(), found));
  }
}

/// Whether the path is a config. Everything else is taken as a mesh, and refused as one if it is
/// none.
bool is_config(storage::FileSystem& files, const fs::path& path) {
  const bool is_json = path.extension() == ".json";
  if (files.is_directory(path))
    return is_json;
  if (mesh_io::is_container(files, path))
    return false;
  const auto file = files.open(path);
  const auto format = mesh_io::find_format(*file);
  if (is_json) {
    if (format && format->kind == mesh_io::MeshKind::tileset)
      return false;
    refuse_foreign(path, first_bytes(*file));
    return true;
  }
  if (format)
    return false;
  const std::string start = first_bytes(*file);
  refuse_foreign(path, start);
  if (begins_as_config(start))
    return true;
  if (mesh_io::is_mesh_name(path.filename().string()))
    return false;
  files.input().open(path);  // throws for a file that must not be read, so that none is quoted
  throw Error(ErrorCode::usage,
              fmt::format("{}: expected a mesh ({}, perhaps in gzip) or a config (JSON), found {}",
                          path.string(), mesh_io::format_names(),
                          start.empty() ? "an empty file" : mesh_io::in_quotes(start)));
}

/// Whether a path is that of a hierarchy, there or to be: a 3D Tiles archive of others is a mesh.
bool is_output(storage::FileSystem& files, const fs::path& path) {
  const std::string ending = path.extension().string();
  return ending == ".hier" ||
         (ending == ".3tz" && (!mesh_io::is_container(files, path) || is_hierarchy(files, path)));
}

/// Throws if the output stands behind the meshes, as other programs take it.
void require_no_output_among(storage::FileSystem& files, const std::vector<fs::path>& named) {
  if (named.size() > 1 && is_output(files, named.back())) {
    throw Error(ErrorCode::usage,
                named.back().string() + ": this is no mesh; the output is named by -o");
  }
}

}  // namespace

bool is_hierarchy(storage::FileSystem& files, const fs::path& path) {
  return files.input().kind(storage::manifest_path(path)) == storage::FileKind::regular;
}

Config load_named(storage::FileSystem& files, const std::vector<fs::path>& named,
                  CommandLine words) {
  return with_files(files, read_named(files, named, std::move(words)));
}

Config read_named(storage::FileSystem& files, const std::vector<fs::path>& named,
                  CommandLine words) {
  require_no_output_among(files.input(), named);
  const auto config =
      std::ranges::find_if(named, [&](const fs::path& path) { return is_config(files, path); });
  if (config == named.end()) {
    words.meshes.assign(named.begin(), named.end());
    return parse_config("{}", {"--set", {}}, words);
  }
  if (named.size() == 1)
    return read_config(files, *config, words);
  throw Error(ErrorCode::usage, fmt::format("{} is a config: a build takes one config, or meshes; "
                                            "a config names its meshes by the key \"input\"",
                                            config->string()));
}

}  // namespace meshhier::config
