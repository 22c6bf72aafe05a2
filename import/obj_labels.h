// What triangles of an OBJ file belong to, as labels: groups, objects, materials.
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
  /// `names`: gets those of the file. Both must stay.
  ObjLabels(const mesh_io::AttributeChoice& choice, AllLabelNames& names);

  bool are_asked() const { return !asked_.empty(); }
  /// Of the triangles from here on.
  void begin(ObjLabel label, const std::string& name);
  /// Of one more triangle: the number of its combination, from 1 on. Throws as LabelNames.
  std::uint32_t use();

  /// Those that the file has statements of.
  std::vector<ScalarAttribute> attributes() const;
  /// A channel for each of attributes(); 0: what is of no triangle. Valid until the next call.
  std::span<const float> channels(std::uint32_t combination);

 private:
  static constexpr std::size_t kLabels = 3;
  using Combination = std::array<std::uint16_t, kLabels>;

  std::vector<std::size_t> asked_;  ///< ObjLabel, in their order
  AllLabelNames& names_;
  std::array<std::optional<std::string>, kLabels> names_now_;  ///< none before the first statement
  std::uint32_t current_ = 0;                                  ///< 0: to be looked up
  std::map<Combination, std::uint32_t> numbers_;
  std::vector<Combination> combinations_;
  std::vector<float> channels_;
};

}  // namespace meshhier::importing
