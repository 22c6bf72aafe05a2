// The places of blobs in scratch files, as the journal keeps them.
#pragma once

#include "storage/io/blob_store.h"

#include <cstddef>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

inline nlohmann::json to_json(const storage::StoredBlob& blob) {
  return {blob.offset, blob.bytes, blob.checksum};
}

/// Restores a blob; returns false if the scratch file does not hold it as it was. Throws
/// nlohmann::json::exception if `stored` is nothing of the kind.
inline bool restore(storage::BlobStore& store, std::size_t index, const nlohmann::json& stored) {
  return store.restore(index, {stored.at(0), stored.at(1), stored.at(2)});
}

}  // namespace meshhier::pipeline
