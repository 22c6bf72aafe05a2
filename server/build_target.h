// Where the hierarchy of a dropped file goes, and whether it is there already.
#pragma once

#include "server/hierarchies.h"
#include "storage/io/file.h"

#include <cstdint>
#include <functional>
#include <optional>
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
  std::string name;  ///< in the folder; of `nowhere`: the last one looked at
};

struct TargetFolder {
  Hierarchies& hierarchies;
  const storage::Folder& folder;
  std::string suffix;  ///< ".hier"
};

/// For the file `name` of that version, among all `inbox` files. "a.ply" goes to "a.hier"; to
/// "a.ply.hier" if a.hier was made from something else, or an inbox file earlier in the alphabet
/// has the same stem. "house/a.obj" goes to "house.hier", or "house.a.obj.hier". A hierarchy of a
/// file of its name and size is made of it if `checksum_for` that hierarchy, which is asked for no
/// other, is the one it was made of; if it is not known, it is made of another version. No time is
/// compared: a file may be replaced while it is built, and by an older one. Throws Error(io), and
/// what `checksum_for` throws.
BuildTarget find_target(
    TargetFolder target, const std::string& name, std::uint64_t bytes,
    const std::vector<std::string>& inbox,
    const std::function<std::optional<std::uint64_t>(const std::string&)>& checksum_for);

}  // namespace meshhier::server
