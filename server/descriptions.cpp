#include "server/descriptions.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "storage/io/json_text.h"
#include "storage/io/system_failure.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::server {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMostFileBytes = std::uint64_t{16} << 20;
constexpr std::size_t kMostTextBytes = 1000;  // as the page reads
constexpr std::size_t kMostModelTags = 50;
constexpr std::size_t kMostShownBytes = 200;

/// Reads what the file says of one model.
class DescriptionReader {
 public:
  DescriptionReader(std::string place, const std::function<void(const std::string&)>& tell)
      : place_(std::move(place)), tell_(tell) {}

  Description read(const Json& json) {
    Description description;
    if (!json.is_object()) {
      refuse("it is no object");
      return description;
    }
    for (const auto& [key, value] : json.items()) {
      if (key == "title")
        description.title = text(key, value);
      else if (key == "folder")
        description.folder = folder(key, value);
      else if (key == "tags")
        description.tags = tags(value);
      else if (key == "place")
        description.place = place(value);
      else
        refuse("there is no key \"" + key + "\"; there are title, folder, tags and place");
    }
    return description;
  }

 private:
  void refuse(const std::string& what) const {
    tell_(place_ + ": " + plain_text(what, kMostShownBytes) + "; not used");
  }

  std::string text(const std::string& key, const Json& value) const {
    if (value.is_string() && value.get_ref<const std::string&>().size() <= kMostTextBytes)
      return value.get<std::string>();
    refuse(fmt::format("\"{}\" is no text of at most {} bytes", key, kMostTextBytes));
    return {};
  }

  /// Slashes at the ends mean nothing.
  std::string folder(const std::string& key, const Json& value) const {
    const std::string given = text(key, value);
    const std::size_t first = given.find_first_not_of('/');
    return first == std::string::npos
               ? std::string()
               : given.substr(first, given.find_last_not_of('/') - first + 1);
  }

  std::vector<std::string> tags(const Json& value) const {
    std::vector<std::string> found;
    if (!value.is_array() || value.size() > kMostModelTags) {
      refuse(fmt::format("\"tags\" is no list of at most {} texts", kMostModelTags));
      return found;
    }
    for (const Json& tag : value) {
      if (std::string one = text("tags", tag); !one.empty())
        found.push_back(std::move(one));
    }
    return found;
  }

  std::optional<GlobePlace> place(const Json& value) const {
    const bool are_numbers =
        value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
    if (are_numbers) {
      const GlobePlace found{value[0].get<double>(), value[1].get<double>()};
      if (std::abs(found.longitude) <= 180 && std::abs(found.latitude) <= 90)
        return found;
    }
    refuse("\"place\" is not [longitude, latitude] in degrees");
    return std::nullopt;
  }

  std::string place_;
  const std::function<void(const std::string&)>& tell_;
};

}  // namespace

DescriptionTable parse_descriptions(std::string_view text, const std::string& name,
                                    const std::function<void(const std::string&)>& tell) {
  Json document;
  try {
    document = storage::parse_ordered_json_text(text);
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorCode::usage, name + ": " + json_fault(error.what()));
  }
  const auto models = document.is_object() ? document.find("models") : document.end();
  if (models == document.end() || !models->is_object())
    throw Error(ErrorCode::usage,
                name + ": it has no object \"models\" with a key for each model's path");
  DescriptionTable table;
  for (const auto& [path, value] : models->items()) {
    const std::string place = name + ": " + plain_text(path, kMostShownBytes);
    table.insert_or_assign(path, DescriptionReader(place, tell).read(value));
  }
  return table;
}

Descriptions::Descriptions(std::shared_ptr<const storage::Folder> folder, Tell tell)
    : folder_(std::move(folder)), tell_(std::move(tell)) {}

std::shared_ptr<const DescriptionTable> Descriptions::read() {
  const auto file = folder_->open(kDescriptionsName);
  const std::lock_guard lock(mutex_);
  const auto version = file ? std::optional(file->version()) : std::nullopt;
  if (version == version_)
    return table_;
  table_ = std::make_shared<const DescriptionTable>(file ? parsed(*file) : DescriptionTable());
  version_ = version;
  return table_;
}

DescriptionTable Descriptions::parsed(const storage::File& file) const {
  const std::string name = file.path().string();
  try {
    if (file.size() > kMostFileBytes)
      throw Error(ErrorCode::usage,
                  fmt::format("{}: it has more than {} bytes", name, kMostFileBytes));
    const auto bytes = storage::read_file(file, kMostFileBytes);
    return parse_descriptions({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name,
                              tell_);
  } catch (const storage::Busy&) {
    throw;
  } catch (const Error& error) {
    tell_(std::string(error.what()) + "; not used");
    return {};
  }
}

}  // namespace meshhier::server
