#include "storage/io/web_address.h"

#include "base/small_letters.h"

#include <memory>
#include <new>

#include <curl/curl.h>
#include <fmt/format.h>

namespace meshhier::storage {

WebAddressParts address_parts(const std::string& address) {
  const std::unique_ptr<CURLU, void (*)(CURLU*)> url(curl_url(), curl_url_cleanup);
  if (url == nullptr)
    throw std::bad_alloc();
  if (curl_url_set(url.get(), CURLUPART_URL, address.c_str(), 0) != CURLUE_OK)
    return {};
  const auto part = [&](CURLUPart name) -> std::optional<std::string> {
    char* text = nullptr;
    if (curl_url_get(url.get(), name, &text, CURLU_URLDECODE | CURLU_DEFAULT_PORT) != CURLUE_OK)
      return std::nullopt;
    return std::unique_ptr<char, void (*)(void*)>(text, curl_free).get();
  };
  WebAddressParts parts{{}, part(CURLUPART_USER), part(CURLUPART_PASSWORD)};
  if (const auto host = part(CURLUPART_HOST))
    parts.origin = fmt::format("{}://{}:{}", part(CURLUPART_SCHEME).value_or(""),
                               small_letters(*host), part(CURLUPART_PORT).value_or(""));
  return parts;
}

bool is_same_host(const std::string& a, const std::string& b) {
  const auto origin = address_parts(a).origin;
  return origin && origin == address_parts(b).origin;
}

bool is_web_address(std::string_view text) {
  const std::string scheme = small_letters(text.substr(0, text.find('/')));
  return (scheme == "http:" || scheme == "https:") && text.substr(scheme.size()).starts_with("//");
}

}  // namespace meshhier::storage
