// One table defines what a view is. Links, JSON in configs and manifests, and the references of the
// config's keys are read by it (docs/file_format.md, section 2.1); view_link.h has the links.
//
//   link   #MODEL&1,2,3,0,0,0&colours=attribute&attribute=distance&range=-0.5,0.5
//   JSON   {"camera": [1, 2, 3, 0, 0, 0], "colours": "attribute", "attribute": "distance",
//           "range": [-0.5, 0.5]}
//
// JSON is read strictly: what is unknown or wrong is told. Links are read leniently: what cannot be
// read is as if it were not there, for people cut them and programs change.
#pragma once

#include "hierarchy/model_view.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::storage {

/// A view's JSON has at most so many bytes: a manifest of at most 1 MiB has it twice.
inline constexpr std::size_t kMostViewBytes = std::size_t{64} * 1024;

/// The member that holds a key's value.
using ViewField =
    std::variant<bool ModelView::*, std::string ModelView::*, std::optional<double> ModelView::*,
                 std::vector<double> ModelView::*, std::vector<std::string> ModelView::*>;

/// A link that names any key of a part replaces the whole part: its other keys get their defaults.
/// Parts that a link does not name stay as in the model's first view.
enum class ViewPart : std::uint8_t {
  camera,
  projection,
  look,
  standing,
  dollhouse,
  level,
  cut,
  rooms,
  measure,
  pick,
  objects
};

/// A key of a view.
struct ViewKey {
  std::string_view name;
  ViewPart part{};
  ViewField field;
  std::string_view meaning;          ///< for people, as that of a config's key
  std::string_view expected;         ///< for messages: "two numbers"; empty: one of `words`
  std::string_view unset{};          ///< for people: what holds if it is not there
  nlohmann::ordered_json schema;     ///< of its value, in JSON schema
  std::vector<std::string> words{};  ///< of a text that is one of them
  /// Tells of a value of the field's type whether it may be one.
  bool (*is_sound)(const nlohmann::ordered_json& value) = nullptr;
};

/// Returns all keys, in the order in which links have them. Thread-safe.
std::span<const ViewKey> view_keys();
/// Returns the key of that name, or null.
const ViewKey* find_view_key(std::string_view name);

/// Describes the values that accepts() takes, for messages.
std::string expectation(const ViewKey& key);
/// Whether the value may be that of the key, in a JSON.
bool accepts(const ViewKey& key, const nlohmann::ordered_json& value);
/// Stores a value that accepts() takes.
void assign(const ViewKey& key, const nlohmann::ordered_json& value, ModelView& view);
/// Returns the value of a key as JSON has it; null if it has its default.
nlohmann::ordered_json value_json(const ViewKey& key, const ModelView& view);

/// A key that makes a view wrong, and the values that it may have.
struct ViewProblem {
  std::string key;  ///< empty: the view itself
  std::string expected;
};

/// Returns what is wrong with keys of a view that are right each by itself; nothing if all is.
std::optional<ViewProblem> problem_between_keys(const ModelView& view);

/// Reads a view, or tells what is wrong with it. Who names an attribute and no colours wants those.
std::variant<ModelView, ViewProblem> parse_view(const nlohmann::ordered_json& json);
/// Returns an object that parse_view() reads as the same view; keys in the table's order.
nlohmann::ordered_json view_json(const ModelView& view);

}  // namespace meshhier::storage
