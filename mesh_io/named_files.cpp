#include "mesh_io/named_files.h"

#include "base/small_letters.h"

#include <algorithm>

namespace meshhier::mesh_io {
namespace {

/// Removes "." and empty parts. A ".." behind a link leads to a place that only the system knows,
/// so those stay.
std::filesystem::path tidy(const std::filesystem::path& name) {
  return std::ranges::find(name, "..") == name.end() ? name.lexically_normal() : name;
}

/// Returns a name with slashes, as it is and without a comment.
std::vector<std::string> spellings(std::string_view name) {
  std::vector<std::string> all{std::string(name)};
  std::ranges::replace(all[0], '\\', '/');
  if (const std::size_t comment = all[0].find(" #"); comment != std::string::npos)
    all.push_back(all[0].substr(0, all[0].find_last_not_of(' ', comment) + 1));
  return all;
}

}  // namespace

bool is_possible(const std::filesystem::path& path) {
  constexpr std::size_t kLongestPath = 4095;
  constexpr std::size_t kLongestPart = 255;
  return path.native().size() <= kLongestPath && path.native().find('\0') == std::string::npos &&
         std::ranges::all_of(path, [](const std::filesystem::path& part) {
           return part.native().size() <= kLongestPart;
         });
}

std::vector<std::filesystem::path> sought_places(const std::filesystem::path& folder,
                                                 std::string_view name) {
  std::vector<std::filesystem::path> places;
  for (const std::string& spelling : spellings(name)) {
    for (const std::filesystem::path& place :
         {folder / tidy(spelling), folder / std::filesystem::path(spelling).filename()}) {
      if (!spelling.empty() && is_possible(place) &&
          std::ranges::find(places, place) == places.end())
        places.push_back(place);
    }
  }
  return places;
}

std::optional<std::filesystem::path> NamedFiles::find(const Path& folder, std::string_view name) {
  for (const std::string& spelling : spellings(name)) {
    if (auto found = find_written(folder, spelling))
      return found;
  }
  return std::nullopt;
}

std::optional<std::filesystem::path> NamedFiles::find_written(const Path& folder,
                                                              const std::string& name) {
  const Path asked = folder / tidy(name);
  if (name.empty() || !is_possible(asked))
    return std::nullopt;
  if (is_file(asked))
    return asked;
  if (auto found = find_any_case(folder, tidy(name)))
    return found;
  const Path last = Path(name).filename();
  return is_file(folder / last) ? folder / last : find_any_case(folder, last);
}

std::optional<std::filesystem::path> NamedFiles::find_any_case(Path folder, const Path& name) {
  for (const Path& part : name) {
    if (part == "." || part.empty())
      continue;
    if (part != "..") {
      const Names& names = names_in(folder);
      const auto [first, last] = names.equal_range(small_letters(part.string()));
      if (first == last || std::next(first) != last)
        return std::nullopt;
      folder /= first->second;
    } else {
      folder /= part;
    }
  }
  return is_file(folder) ? std::optional(folder) : std::nullopt;
}

const NamedFiles::Names& NamedFiles::names_in(const Path& folder) {
  const auto [found, is_new] = folders_.try_emplace(folder);
  const Path looked = folder.empty() ? Path(".") : folder;
  if (is_new && files_.is_directory(looked)) {
    for (const Path& child : files_.children(looked))
      found->second.emplace(small_letters(child.filename().string()), child.filename().string());
  }
  return found->second;
}

}  // namespace meshhier::mesh_io
