// The files of a progressive stream: base.bin, detail_NN.bin (docs/file_format.md).
#pragma once

#include "hierarchy/detail.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::progressive {

/// Returns the head of the file of `step`; runs follow.
std::vector<std::byte> detail_head(std::uint32_t step);

/// Returns a run as it is stored. `first`: the least index that it could begin with, that is the
/// one behind the run before it in the list, or 0. Requires 1 to kRunEntries entries, ascending.
/// Deterministic for one zlib. Thread-safe.
std::vector<std::byte> encode_run(const DetailRun& run, const AttributeLayout& layout,
                                  std::uint64_t first);

/// Reads a file's bytes, which nobody vouches for, run by run. `bytes` must outlive it.
class DetailFileReader {
 public:
  /// Throws Error(corrupt) that starts with `name` if it is no file of `step`.
  DetailFileReader(std::span<const std::byte> bytes, std::uint32_t step,
                   const AttributeLayout& layout, std::string name);

  /// Returns the next run; nothing at the end. Takes memory for one run. Throws Error(corrupt) that
  /// starts with the name. Indices ascend within a list and are below 2^32 (triangles': 2^63).
  std::optional<DetailRun> next();

 private:
  std::span<const std::byte> bytes_;
  AttributeLayout layout_;
  std::string name_;
  std::size_t place_ = 0;
  std::uint32_t list_ = 1;   ///< the last run's
  std::uint64_t first_ = 0;  ///< least index that the list can go on with
};

}  // namespace meshhier::progressive
