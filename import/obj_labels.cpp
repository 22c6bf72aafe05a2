#include "import/obj_labels.h"

#include "base/named_value.h"

namespace meshhier::importing {
namespace {

constexpr std::array kLabelRows{NamedValue{"group", ObjLabel::group},
                                NamedValue{"object", ObjLabel::object},
                                NamedValue{"material", ObjLabel::material}};

std::string label_name(std::size_t label) {
  return std::string(name_in(kLabelRows, static_cast<ObjLabel>(label)));
}

}  // namespace

ObjLabels::ObjLabels(const mesh_io::AttributeChoice& choice, AllLabelNames& names) : names_(names) {
  for (const auto& [name, label] : kLabelRows) {
    if (choice.which == mesh_io::AttributeChoice::Which::named && choice.takes(name))
      asked_.push_back(static_cast<std::size_t>(label));
  }
}

void ObjLabels::begin(ObjLabel label, const std::string& name) {
  names_now_[static_cast<std::size_t>(label)] = name;
  current_ = 0;
}

std::uint32_t ObjLabels::use() {
  if (current_ > 0)
    return current_;
  Combination combination{};
  for (const std::size_t label : asked_) {
    if (names_now_[label])
      combination[label] = names_[label_name(label)].number(*names_now_[label]);
  }
  const auto [known, is_new] =
      numbers_.try_emplace(combination, static_cast<std::uint32_t>(combinations_.size() + 1));
  if (is_new)
    combinations_.push_back(combination);
  return current_ = known->second;
}

std::vector<ScalarAttribute> ObjLabels::attributes() const {
  std::vector<ScalarAttribute> all;
  for (const std::size_t label : asked_) {
    if (names_now_[label])
      all.push_back({label_name(label), ValueType::u16, true});
  }
  return all;
}

std::span<const float> ObjLabels::channels(std::uint32_t combination) {
  channels_.clear();
  for (const std::size_t label : asked_) {
    if (names_now_[label])
      channels_.push_back(combination == 0 ? 0.0F
                                           : combinations_[combination - std::size_t{1}][label]);
  }
  return channels_;
}

}  // namespace meshhier::importing
