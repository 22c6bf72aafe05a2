#include "server/secret.h"

#include "base/small_letters.h"
#include "base/trimmed.h"

#include <cstddef>
#include <string>

namespace meshhier::server {
namespace {

std::string_view bearer_of(const Request& request) {
  constexpr std::string_view kScheme = "bearer ";
  const std::string_view value =
      request.authorization ? std::string_view(*request.authorization) : std::string_view();
  return small_letters(value.substr(0, kScheme.size())) == kScheme
             ? trimmed(value.substr(kScheme.size()))
             : std::string_view();
}

}  // namespace

bool is_same_secret(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^
                  static_cast<unsigned char>(b.empty() ? ~a[i] : b[i % b.size()]);
  return difference == 0;
}

bool knows_secret(const Request& request, std::string_view secret) {
  return is_same_secret(bearer_of(request), secret);
}

Reply secret_needed() {
  Reply reply = text_reply(401, "The token is missing or wrong (Authorization: Bearer TOKEN).");
  reply.headers.emplace_back("WWW-Authenticate", "Bearer");
  return reply;
}

}  // namespace meshhier::server
