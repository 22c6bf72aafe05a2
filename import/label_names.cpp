#include "import/label_names.h"

#include "base/error.h"

#include <fmt/format.h>

namespace meshhier::importing {

std::uint16_t LabelNames::number(const std::string& name) {
  const auto [known, is_new] =
      numbers_.try_emplace(name, static_cast<std::uint16_t>(names_.size() + 1));
  if (!is_new)
    return known->second;
  bytes_ += name.size();
  if (names_.size() == kMost || bytes_ > kMostBytes) {
    throw Error(ErrorCode::input,
                fmt::format("the input has more than {} names of a label, or {} bytes of them; "
                            "leave it out of \"attributes\"",
                            kMost, kMostBytes));
  }
  names_.push_back(name);
  return known->second;
}

}  // namespace meshhier::importing
