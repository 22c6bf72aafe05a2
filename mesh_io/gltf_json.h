// The JSON of a glTF file: parsed within limits, and read value by value with checks.
#pragma once

#include "hierarchy/object_row.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::mesh_io {

/// A glTF nests 8 levels; extensions and extras add some more.
inline constexpr int kDeepestGltfJson = 64;

/// Parses `text`, which is freed. Throws Error(input) naming `path` if it is no JSON or nested
/// deeper than `most_depth` levels, and Error(budget) if it would take more than `most_bytes` of
/// memory.
nlohmann::json parse_gltf_json(std::string text, const std::filesystem::path& path,
                               std::uint64_t most_bytes, int most_depth = kDeepestGltfJson);

/// An object of the JSON with its place in it ("accessors[3]"), for messages. Getters throw
/// Error(input) naming file and place if a value is not of the expected kind. The JSON and the path
/// must outlive it.
class GltfObject {
 public:
  GltfObject(const nlohmann::json& object, const std::filesystem::path& path,
             std::string place = {});

  bool has(const char* key) const { return find(key) != nullptr; }
  bool has_object(const char* key) const;
  /// Returns an integer from 0 to `most`; 2.0 is one. Nothing if there is no such key.
  std::optional<std::uint64_t> count(const char* key, std::uint64_t most) const;
  std::uint64_t require_count(const char* key, std::uint64_t most) const;
  /// Returns the number of an item in a list of `size` items: it is below `size`.
  std::optional<std::uint32_t> index(const char* key, std::size_t size) const;
  std::uint32_t require_index(const char* key, std::size_t size) const;
  double number(const char* key, double otherwise) const;
  bool flag(const char* key) const;
  std::optional<std::string> text(const char* key) const;
  /// Returns whether there is a text that begins with `start`.
  bool has_text(const char* key, std::string_view start) const;
  /// Returns a list of `size` numbers; nothing if there is no such key.
  std::optional<std::vector<double>> numbers(const char* key, std::size_t size) const;
  std::vector<std::uint32_t> indices(const char* key, std::size_t size) const;
  std::vector<std::string> texts(const char* key) const;
  /// Returns the first `most` of its keys.
  std::vector<std::string> keys(std::size_t most) const;
  /// Returns whether there is a list of `size` numbers.
  bool has_numbers(const char* key, std::size_t size) const;
  std::optional<GltfObject> object(const char* key) const;
  GltfObject require_object(const char* key) const;
  /// Returns this object's extension of that name.
  std::optional<GltfObject> extension(const char* name) const;
  /// Visits the objects of a list, if there is one.
  void for_each(const char* key, const std::function<void(const GltfObject&)>& visit) const;
  std::size_t item_count(const char* key) const;
  /// Returns an object of a list; nothing if the list has no such item.
  std::optional<GltfObject> item(const char* key, std::size_t number) const;
  /// Calls `visit(key, index)` for each member; all must be numbers of items in a list of `size`
  /// items.
  void for_each_index(std::size_t size,
                      const std::function<void(const std::string&, std::uint32_t)>& visit) const;

  /// Returns the members of an object, by key, as value_of_json() has them; none if there is no
  /// such object.
  std::vector<std::pair<std::string, ObjectValue>> values(const char* key) const;
  /// Returns a member as value_of_json() has it; none if there is no such key.
  ObjectValue value(const char* key) const;
  /// Returns the JSON by itself.
  std::shared_ptr<const nlohmann::json> copy() const;

  /// Returns where it stands in the JSON: "accessors[3]"; empty for the whole document.
  const std::string& place() const { return place_; }
  [[noreturn]] void fail(const std::string& message) const;

 private:
  const nlohmann::json* find(const char* key) const;
  const nlohmann::json* find_list(const char* key) const;
  std::string place_of(std::string_view key) const;
  /// Throws Error(input): "accessors[3].count is -1, expected EXPECTED".
  [[noreturn]] void fail_value(const char* key, const std::string& expected) const;
  std::uint64_t checked_count(const nlohmann::json& value, const char* key,
                              std::uint64_t most) const;

  const nlohmann::json* object_;
  const std::filesystem::path* path_;
  std::string place_;
};

}  // namespace meshhier::mesh_io
