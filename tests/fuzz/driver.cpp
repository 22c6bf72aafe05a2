// One fuzz target as libFuzzer calls it: MESHHIER_FUZZ_TARGET is the name of the body.
#include "fuzz/targets.h"

#include <cstddef>
#include <cstdint>
#include <span>

/// An exception that escapes from the body ends the process, and libFuzzer keeps the input.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  meshhier::tests::fuzz::MESHHIER_FUZZ_TARGET(std::as_bytes(std::span(data, size)));
  return 0;
}
