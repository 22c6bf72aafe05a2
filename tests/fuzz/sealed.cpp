#include "fuzz/sealed.h"

#include "fuzz/target.h"
#include "storage/format/glb.h"
#include "storage/io/hash.h"

#include <fmt/format.h>

namespace meshhier::tests::fuzz {

std::string sealed_manifest(std::string_view text) {
  constexpr std::string_view kEnd = "\"\n}\n";
  constexpr std::size_t kDigits = 16;
  std::string result(text);
  if (result.size() < kDigits + kEnd.size())
    return result;
  const std::size_t place = result.size() - kEnd.size() - kDigits;
  result.replace(place, kDigits, std::string(kDigits, '0'));
  result.replace(place, kDigits, fmt::format("{:016x}", storage::checksum(bytes_of(result))));
  return result;
}

std::vector<std::byte> sealed_index(Bytes bytes) {
  constexpr std::size_t kChecksumPlace = 24;
  constexpr std::size_t kRecordsPlace = 32;
  std::vector<std::byte> result(bytes.begin(), bytes.end());
  if (result.size() < kRecordsPlace)
    return result;
  storage::Checksum sum;
  sum.add(Bytes(result).first(kChecksumPlace));
  sum.add(Bytes(result).subspan(kRecordsPlace));
  storage::store_little(sum.value(), result.data() + kChecksumPlace);
  return result;
}

}  // namespace meshhier::tests::fuzz
