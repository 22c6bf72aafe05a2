#include "app/program_id.h"

#include "storage/io/hash.h"
#include "storage/io/own_program.h"

#include <fmt/format.h>

namespace meshhier::app {

std::string program_id(storage::FileSystem& files) {
  const auto program = files.open(storage::own_code());
  return fmt::format("meshhier " MESHHIER_VERSION " {:016x}",
                     storage::checksum(storage::read_file(*program, program->size())));
}

}  // namespace meshhier::app
