#include "storage/format/story_pictures.h"

#include "base/percent_code.h"
#include "base/small_letters.h"
#include "hierarchy/image_format.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>

#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

/// JSON that is nested deeper is no story; the pictures of IIIF manifests are some twenty deep.
constexpr int kDeepestStory = 64;

/// Returns a part of an address as a file's name; nothing if it cannot be one.
std::optional<std::string> part_name(std::string_view part) {
  std::optional<std::string> name = percent_decoded(part);
  const auto is_none = [](char c) {
    return c == '/' || c == '\\' || static_cast<unsigned char>(c) < ' ';
  };
  return name && std::ranges::none_of(*name, is_none) ? std::move(name) : std::nullopt;
}

/// Takes a step along a path; returns false if it does not stay beside the story.
bool take_step(std::vector<std::string>& path, std::string_view part) {
  const std::optional<std::string> name = part_name(part);
  if (!name || name->empty())
    return false;
  if (*name == ".")
    return true;
  if (*name == "..") {
    const bool is_below = !path.empty();
    if (is_below)
      path.pop_back();
    return is_below;
  }
  path.push_back(*name);
  return name->front() != '.';
}

/// Resolves an address as browsers do; returns nothing if it does not lead downwards from the
/// story's folder.
std::optional<std::string> path_beside(std::string_view address) {
  address = address.substr(0, address.find_first_of("?#"));
  const std::size_t slash = address.find('/');
  if (address.empty() || slash == 0 || address.substr(0, slash).find(':') != std::string_view::npos)
    return std::nullopt;
  std::vector<std::string> parts;
  while (true) {
    const std::size_t end = std::min(address.find('/'), address.size());
    if (!take_step(parts, address.substr(0, end)))
      return std::nullopt;
    if (end == address.size())
      break;
    address.remove_prefix(end + 1);
  }
  std::string path;
  for (const std::string& part : parts)
    path += path.empty() ? part : '/' + part;
  return is_picture_name(path) ? std::optional(path) : std::nullopt;
}

void collect_pictures(const nlohmann::json& value, std::set<std::string>& found) {
  if (value.is_object() && value.value("type", nlohmann::json()) == "Image") {
    const auto id = value.find("id");
    if (id != value.end() && id->is_string()) {
      if (auto path = path_beside(id->get_ref<const std::string&>()))
        found.insert(*std::move(path));
    }
  }
  if (!value.is_structured())
    return;
  for (const nlohmann::json& below : value)
    collect_pictures(below, found);
}

}  // namespace

bool is_picture_name(std::string_view name) {
  const std::string small = small_letters(name.substr(name.rfind('/') + 1));
  return std::ranges::any_of(kBrowserPictures,
                             [&](const PictureFile& file) { return file.is_name(small); });
}

std::vector<std::string> pictures_beside(std::string_view story) {
  const auto shallow = [](int depth, auto, const auto&) { return depth < kDeepestStory; };
  const nlohmann::json document = parse_json_text(story, shallow, {.throws = false});
  std::set<std::string> found;
  if (!document.is_discarded())
    collect_pictures(document, found);
  return {found.begin(), found.end()};
}

}  // namespace meshhier::storage
