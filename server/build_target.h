// The place for the hierarchy of a dropped file, and whether it is there already.
#pragma once

#include "server/hierarchies.h"
#include "storage/io/folder.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace meshhier::server {

struct BuildTarget {
  enum class Kind {
    build,    ///< there is nothing of that name
    replace,  ///< there is the hierarchy of an earlier version of the file
    done,     ///< it is made of this very file
    nowhere   ///< both names are taken by something else
  };
  Kind kind = Kind::nowhere;
  std::string name;  ///< in the folder; if `nowhere`, the last one looked at
};

struct TargetFolder {
  Hierarchies& hierarchies;
  const storage::Folder& folder;
  std::string suffix;  ///< ".hier"
};

/// Returns by how many bytes the name of a hierarchy is too long for all that lies beside it,
/// whichever of the two names below a mesh's file gets; 0 if neither is.
std::size_t excess_of_name(const std::string& name, const std::string& suffix);

/// Finds the place for the file `name`, among all `inbox` files. "a.ply" goes to "a.hier"; to
/// "a.ply.hier" if a.hier was made from something else, or an inbox file earlier in the alphabet
/// has the same stem. "house/a.obj" goes to "house.hier", or "house.a.obj.hier". `is_made_of` says
/// whether a hierarchy of a file of that name is one of this very file, and is asked for no other.
/// Throws Error(io), and what `is_made_of` throws.
BuildTarget find_target(TargetFolder target, const std::string& name,
                        const std::vector<std::string>& inbox,
                        const std::function<bool(const Model&)>& is_made_of);

/// Throws Error(usage) if the name of the inbox's file cannot be part of a URL, or is too long;
/// Error(exists) if `folder` has no place for its hierarchy.
void check_target(const BuildTarget& target, const std::string& name,
                  const std::filesystem::path& folder);

}  // namespace meshhier::server
