// Checks that an output's name does not promise another format than it gets.
#pragma once

#include <initializer_list>
#include <string_view>

namespace meshhier::mesh_io {

/// Throws Error(usage), "NAME: ADVICE", if the name ends as files of a known format do, other than
/// those of `own` (in small letters, with the dot). Capitals and small letters are the same.
void require_true_ending(std::string_view name, std::initializer_list<std::string_view> own,
                         std::string_view advice);

}  // namespace meshhier::mesh_io
