// The names that numbers of labels stand for: groups, objects and materials of OBJ files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace meshhier::importing {

/// The names of one label in all files of an input, by first use.
class LabelNames {
 public:
  /// The most different names, and the most bytes of all.
  static constexpr std::size_t kMost = 65535;
  static constexpr std::size_t kMostBytes = std::size_t{1} << 24;

  /// Returns the number of a name, from 1 on; 0 is no name. Throws Error(input) beyond the limits.
  std::uint16_t number(const std::string& name);
  /// Returns the name of a number, which must be one's.
  const std::string& name(std::uint16_t number) const { return names_[number - std::size_t{1}]; }
  std::size_t count() const { return names_.size(); }

 private:
  std::size_t bytes_ = 0;
  std::map<std::string, std::uint16_t> numbers_;
  std::vector<std::string> names_;
};

/// The names of all labels, by the attribute's name.
using AllLabelNames = std::map<std::string, LabelNames>;

}  // namespace meshhier::importing
