#include "server/client_key.h"

#include <algorithm>
#include <array>

#include <arpa/inet.h>
#include <netinet/in.h>

namespace meshhier::server {
namespace {

constexpr std::size_t kNetworkBytes = 8;
constexpr std::size_t kMappedPrefixBytes = 12;

std::string text_of(int family, const void* bytes) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  ::inet_ntop(family, bytes, text.data(), text.size());
  return text.data();
}

}  // namespace

std::string client_key(const std::string& address) {
  in6_addr bytes{};
  const std::string without_zone = address.substr(0, address.find('%'));
  if (::inet_pton(AF_INET6, without_zone.c_str(), &bytes) != 1)
    return address;
  if (IN6_IS_ADDR_V4MAPPED(&bytes))
    return text_of(AF_INET, bytes.s6_addr + kMappedPrefixBytes);
  std::fill(bytes.s6_addr + kNetworkBytes, bytes.s6_addr + sizeof(bytes.s6_addr), 0);
  return text_of(AF_INET6, &bytes) + "/64";
}

bool is_loopback_client(const std::string& address) {
  const std::string key = client_key(address);
  in6_addr bytes{};
  return key.starts_with("127.") ||
         (::inet_pton(AF_INET6, address.c_str(), &bytes) == 1 && IN6_IS_ADDR_LOOPBACK(&bytes));
}

}  // namespace meshhier::server
