#include "storage/io/file_rights.h"

#include <sys/stat.h>
#include <unistd.h>

namespace meshhier::storage {

bool is_open_to_others(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0)
    return false;
  const mode_t others = status.st_uid == ::geteuid() ? S_IRWXG | S_IRWXO : S_IRWXO;
  return (status.st_mode & others) != 0;
}

}  // namespace meshhier::storage
