// The choice of what the objects of a mesh are made from.
#pragma once

#include "base/named_value.h"
#include "hierarchy/scalar_value.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::mesh_io {

/// The bytes of the longest name of an object.
inline constexpr std::size_t kMostObjectNameBytes = std::size_t{1} << 19;

enum class ObjectSource : std::uint8_t {
  evident,   ///< what a file evidently means, if there are two names or more
  none,      ///< there are no objects
  node,      ///< nodes of a glTF that show a mesh
  group,     ///< statements g of an OBJ file
  object,    ///< statements o
  material,  ///< materials of OBJ and glTF
  file,      ///< each file of a list
  solid,     ///< solids of an ASCII STL file
  feature,   ///< features of a glTF, or of a b3dm
  label      ///< a label of vertices or faces
};
/// The sources that a word names; a label's is kObjectLabel and its name.
inline constexpr std::array kObjectSources{
    NamedValue{"auto", ObjectSource::evident},   NamedValue{"none", ObjectSource::none},
    NamedValue{"node", ObjectSource::node},      NamedValue{"group", ObjectSource::group},
    NamedValue{"object", ObjectSource::object},  NamedValue{"material", ObjectSource::material},
    NamedValue{"file", ObjectSource::file},      NamedValue{"solid", ObjectSource::solid},
    NamedValue{"feature", ObjectSource::feature}};
inline constexpr std::string_view kObjectLabel = "label:";

struct ObjectChoice {
  ObjectSource from = ObjectSource::evident;
  std::string label{};  ///< name of the label, if that is the source

  bool is_evident() const { return from == ObjectSource::evident; }
  /// Returns whether objects may be made from that.
  bool takes(ObjectSource source) const { return from == source || is_evident(); }
  friend bool operator==(const ObjectChoice&, const ObjectChoice&) = default;
};

/// Returns the choice that a text names: "node", "label:class"; none if it names none.
inline std::optional<ObjectChoice> object_choice_of(std::string_view text) {
  if (const auto source = value_named(kObjectSources, text))
    return ObjectChoice{*source};
  if (!text.starts_with(kObjectLabel) || !is_attribute_name(text.substr(kObjectLabel.size())))
    return std::nullopt;
  return ObjectChoice{ObjectSource::label, std::string(text.substr(kObjectLabel.size()))};
}

/// Returns the text that names it.
inline std::string text_of(const ObjectChoice& choice) {
  return choice.from == ObjectSource::label ? std::string(kObjectLabel) + choice.label
                                            : std::string(name_in(kObjectSources, choice.from));
}

}  // namespace meshhier::mesh_io
