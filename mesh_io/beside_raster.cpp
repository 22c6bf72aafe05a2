#include "mesh_io/beside_raster.h"

#include "mesh_io/asc_head.h"
#include "mesh_io/input_error.h"
#include "mesh_io/number_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

namespace meshhier::mesh_io {
namespace {

constexpr std::size_t kMostBesideBytes = std::size_t{1} << 16;

std::string text_beside(storage::FileSystem& files, const std::filesystem::path& path) {
  std::string text(kMostBesideBytes, '\0');
  text.resize(files.open(path)->read_at(0, std::as_writable_bytes(std::span(text))));
  return text;
}

bool is_beside(storage::FileSystem& files, const std::filesystem::path& path) {
  return files.kind(path) == storage::FileKind::regular;
}

std::string in_capitals(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return text;
}

}  // namespace

std::filesystem::path crs_file_of(const std::filesystem::path& raster) {
  return std::filesystem::path(raster).replace_extension(".prj");
}

std::optional<CrsFile> read_crs_file(storage::FileSystem& files,
                                     const std::filesystem::path& raster) {
  std::filesystem::path path = crs_file_of(raster);
  if (!is_beside(files, path))
    return std::nullopt;
  geodesy::RasterMap keys = keys_of_wkt(text_beside(files, path));
  return CrsFile{std::move(path), std::move(keys)};
}

std::vector<std::filesystem::path> world_files_of(const std::filesystem::path& raster) {
  std::vector<std::filesystem::path> names;
  for (const std::string& ending :
       {std::string(".tfw"), raster.extension().string() + "w", std::string(".wld")}) {
    for (const std::string& form : {ending, in_capitals(ending)}) {
      std::filesystem::path name = std::filesystem::path(raster).replace_extension(form);
      if (std::ranges::find(names, name) == names.end())
        names.push_back(std::move(name));
    }
  }
  return names;
}

std::optional<WorldFile> read_world_file(storage::FileSystem& files,
                                         const std::filesystem::path& raster) {
  const auto names = world_files_of(raster);
  const auto name =
      std::ranges::find_if(names, [&](const auto& one) { return is_beside(files, one); });
  if (name == names.end())
    return std::nullopt;
  const std::string text = text_beside(files, *name);
  std::array<double, 6> numbers{};
  std::string_view left = text;
  for (double& number : numbers) {
    constexpr std::string_view kBlanks = " \t\r\n";
    left.remove_prefix(std::min(left.find_first_not_of(kBlanks), left.size()));
    const std::string_view word = left.substr(0, left.find_first_of(kBlanks));
    const auto value = parse_real<double>(word);
    if (!value || !std::isfinite(*value))
      fail_file(*name, "expected the six numbers of a world file, found " + in_quotes(word));
    number = *value;
    left.remove_prefix(word.size());
  }
  const auto& [a, d, b, e, x, y] = numbers;
  return WorldFile{*name, {{x, y}, {a, d}, {b, e}}};
}

}  // namespace meshhier::mesh_io
