// JSON files that carry their own checksum, and values of JSON that nobody vouches for.
//
// The text of such a file ends with `,\n  "checksum": "` + 16 digits + `"\n}\n`: the XXH3-64 of the
// whole text with zeros in the digits' place, which is known without parsing.
#pragma once

#include "base/vec.h"
#include "hierarchy/attributes.h"
#include "hierarchy/frame.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::storage {

class File;

/// A manifest has about 20 kB: 40 levels of 300 bytes, a config and 30 more lines.
inline constexpr std::size_t kMostSealedBytes = std::size_t{1024} * 1024;

/// The format and version that a file names.
struct SealedFormat {
  std::string_view name;                       ///< `format`
  int version = 0;                             ///< `format_version`, the newest that is read
  std::string_view way_out = "make it again";  ///< advice if a version is too old
  std::size_t most_bytes = kMostSealedBytes;
  int older_versions = 0;  ///< so many before it are read, too
};

/// Returns the text of `document`, an object, between `format` and `checksum`, which are not its
/// own keys. Deterministic; bytes in texts that are no UTF-8 become U+FFFD. Requires finite
/// numbers.
std::string sealed_text(const SealedFormat& format, const nlohmann::ordered_json& document);

/// Reads such a file. Throws Error(io), or Error(corrupt) if it is longer than `most_bytes`.
std::string read_sealed_text(const File& file, std::size_t most_bytes = kMostSealedBytes);

/// Returns the document of a text nobody vouches for. Throws Error(corrupt) that starts with `name`
/// if it is too long, no JSON, of another format or version (a newer one is refused by its number),
/// or was changed.
nlohmann::ordered_json parse_sealed(const std::string& text, const SealedFormat& format,
                                    const std::string& name);

/// An object of a document, asked for its values by key. A value that is missing or wrong throws
/// Error(corrupt) that starts with the document's name, which must outlive the object, as the JSON
/// must.
class JsonObject {
 public:
  JsonObject(const nlohmann::ordered_json& json, std::string path, const std::string& name)
      : json_(json), path_(std::move(path)), name_(name) {}

  const nlohmann::ordered_json& at(const char* key) const;
  bool has(const char* key) const { return json_.contains(key); }
  std::vector<std::string> keys() const;

  JsonObject object(const char* key) const;
  std::vector<JsonObject> objects(const char* key) const;
  std::uint64_t count(const char* key, std::uint64_t max = UINT64_MAX) const;
  std::uint32_t short_count(const char* key) const;
  bool boolean(const char* key) const;
  std::string text(const char* key) const;
  std::vector<std::string> texts(const char* key) const;
  double number(const char* key) const;  ///< finite
  Vec3d point(const char* key) const;
  std::optional<Transform> transform_or_null(const char* key) const;
  std::uint64_t hash(const char* key) const;  ///< as hex_digits() writes it
  AttributeLayout attributes(const char* key) const;
  UpAxis up(const char* key) const;

  [[noreturn]] void wrong(const char* key, const std::string& expected) const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  const nlohmann::ordered_json& json_;
  std::string path_;
  const std::string& name_;
};

/// Returns 16 lower case hexadecimal digits.
std::string hex_digits(std::uint64_t value);
nlohmann::ordered_json point_json(Vec3d point);
nlohmann::ordered_json attributes_json(const AttributeLayout& attributes);

}  // namespace meshhier::storage
