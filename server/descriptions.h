// gallery.json: what people say of the models in a folder (docs/serving.md, "Many models").
//
//   { "models": { "sub/david.hier": { "title": "David", "folder": "Florence/Statues",
//                                     "tags": ["marble", "scan"], "place": [11.2556, 43.7731] } } }
#pragma once

#include "server/globe_place.h"
#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::server {

/// The name of that file, in the folder that is served.
inline constexpr const char* kDescriptionsName = "gallery.json";

/// What is not said is empty.
struct Description {
  std::string title{};
  std::string folder{};  ///< parts joined by '/'; instead of the directory
  std::vector<std::string> tags{};
  std::optional<GlobePlace> place{};  ///< instead of the manifest's
  friend bool operator==(const Description&, const Description&) = default;
};

/// By the models' paths.
using DescriptionTable = std::map<std::string, Description, std::less<>>;

/// Parses a text that nobody vouches for. `tell` hears of each thing in it that is not used. Throws
/// Error(usage) that starts with `name` if it is no such file at all.
DescriptionTable parse_descriptions(std::string_view text, const std::string& name,
                                    const std::function<void(const std::string&)>& tell);

/// The file of a folder, read again when it is another one. Thread-safe.
class Descriptions {
 public:
  /// Hears of what is not used.
  using Tell = std::function<void(const std::string& message)>;

  Descriptions(std::shared_ptr<const storage::Folder> folder, Tell tell);

  /// Returns what the file says by now; an empty table if there is none, or it cannot be read.
  /// Throws storage::Busy.
  std::shared_ptr<const DescriptionTable> read();

 private:
  DescriptionTable parsed(const storage::File& file) const;

  std::shared_ptr<const storage::Folder> folder_;
  Tell tell_;
  std::mutex mutex_;  ///< guards all below
  std::optional<storage::FileVersion> version_;
  std::shared_ptr<const DescriptionTable> table_ = std::make_shared<DescriptionTable>();
};

}  // namespace meshhier::server
