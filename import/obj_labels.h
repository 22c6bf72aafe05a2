// Labels of an OBJ file's triangles: the groups, objects and materials that they belong to.
#pragma once

#include "hierarchy/attributes.h"
#include "import/label_names.h"
#include "mesh_io/attribute_choice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::importing {

enum class ObjLabel : std::uint8_t { group, object, material };

/// Numbers the combinations that triangles have of the labels that are asked for by name.
class ObjLabels {
 public:
  /// `names` gets the names of the file. Both must outlive it.
  ObjLabels(const mesh_io::AttributeChoice& choice, AllLabelNames& names);

  bool are_asked() const { return !asked_.empty(); }
  /// Begins a label: that of the triangles from here on.
  void begin(ObjLabel label, const std::string& name);
  /// Returns the number of one more triangle's combination, from 1 on. Throws as LabelNames.
  std::uint32_t use();

  /// Returns the labels that the file has statements for.
  std::vector<ScalarAttribute> attributes() const;
  /// Returns a channel for each of attributes(); combination 0 stands for vertices of no triangle.
  /// Valid until the next call.
  std::span<const float> channels(std::uint32_t combination);

 private:
  static constexpr std::size_t kLabels = 3;
  using Combination = std::array<std::uint16_t, kLabels>;

  std::vector<std::size_t> asked_;  ///< ObjLabels, in the order of the attributes
  AllLabelNames& names_;
  std::array<std::optional<std::string>, kLabels> names_now_;  ///< none before the first statement
  std::uint32_t current_ = 0;                                  ///< 0: to be looked up
  std::map<Combination, std::uint32_t> numbers_;
  std::vector<Combination> combinations_;
  std::vector<float> channels_;
};

}  // namespace meshhier::importing
