#include "config/map_file.h"

#include "fuzz/target.h"
#include "fuzz/targets.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::tests::fuzz {

void map_file(Bytes input) {
  config::MapFile file;
  const std::string refused =
      refusal({ErrorCode::usage}, "", [&] { file = config::parse_map_file(text_of(input)); });
  if (!refused.empty())
    return;
  require(file.crs || file.offset || file.place, "something is found");
  require(file.crs.value_or("").size() <= std::max<std::size_t>(input.size(), 10),
          "a crs is no longer than its file");
  if (!file.offset)
    return;
  require(std::ranges::all_of(*file.offset, [](double x) { return std::isfinite(x); }),
          "numbers are finite");
  const std::string again = fmt::format("{}", fmt::join(*file.offset, " "));
  require(config::parse_map_file(again).offset == file.offset, "what is written is read again");
}

}  // namespace meshhier::tests::fuzz
