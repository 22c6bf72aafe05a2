// The places of spools in scratch files, as the journal keeps them.
#pragma once

#include "storage/io/spool.h"

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// Puts on disk what was appended to a spool, and returns where it is.
template <class Spool>
nlohmann::json store(Spool& spool) {
  const storage::StoredSpool stored = spool.store();
  return {stored.bytes, stored.checksum, stored.block_bytes, stored.blocks};
}

/// Restores a spool; returns false if `stored` contradicts itself. Throws nlohmann::json::exception
/// if it is nothing of the kind.
template <class Spool>
bool restore(Spool& spool, const nlohmann::json& stored) {
  return spool.restore({stored.at(0), stored.at(1), stored.at(2), stored.at(3)});
}

}  // namespace meshhier::pipeline
