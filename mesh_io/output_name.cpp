#include "mesh_io/output_name.h"

#include "base/error.h"
#include "base/small_letters.h"
#include "mesh_io/other_formats.h"

#include <algorithm>
#include <string>

namespace meshhier::mesh_io {
void require_true_ending(std::string_view name, std::initializer_list<std::string_view> own,
                         std::string_view advice) {
  const std::size_t dot = name.find_last_of("./");
  if (dot == std::string_view::npos || name[dot] != '.')
    return;
  const std::string ending = small_letters(std::string(name.substr(dot)));
  if (std::ranges::find(own, ending) != own.end() || !is_known_ending(ending))
    return;
  throw Error(ErrorCode::usage, std::string(name) + ": " + std::string(advice));
}

}  // namespace meshhier::mesh_io
