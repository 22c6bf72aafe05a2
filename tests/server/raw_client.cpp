#include "tests/server/raw_client.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace meshhier::tests {
namespace {

constexpr timeval kPatience{600, 0};

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

/// "name: value" without its line end.
void add_header(RawReply& reply, const std::string& line) {
  const std::size_t colon = line.find(": ");
  std::string name = line.substr(0, colon);
  for (char& c : name)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  reply.headers[name] = colon == std::string::npos ? "" : line.substr(colon + 2);
}

RawReply parse_reply_head(const std::string& head) {
  RawReply reply;
  std::size_t begin = head.find("\r\n");
  if (!head.starts_with("HTTP/1.1 "))
    throw std::runtime_error("no reply: " + head);
  reply.status = std::atoi(head.c_str() + std::strlen("HTTP/1.1 "));
  for (begin += 2; begin < head.size();) {
    const std::size_t end = head.find("\r\n", begin);
    if (end > begin)
      add_header(reply, head.substr(begin, end - begin));
    begin = end + 2;
  }
  return reply;
}

}  // namespace

RawClient::RawClient(std::uint16_t port, int receive_buffer_bytes, const char* from)
    : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  if (receive_buffer_bytes > 0)
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer_bytes,
                 sizeof(receive_buffer_bytes));
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &kPatience, sizeof(kPatience));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = ::inet_addr(from);
  if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0)
    fail("cannot bind");
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0)
    fail("cannot connect");
}

RawClient::~RawClient() {
  ::close(socket_);
}

void RawClient::send(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count <= 0)
      return;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

bool RawClient::fill() {
  std::array<char, 65536> buffer;
  const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), 0);
  if (count < 0 && errno != ECONNRESET)
    fail("the server is silent");
  if (count > 0)
    received_.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0;
}

RawReply RawClient::receive(bool is_head) {
  constexpr std::string_view kEnd = "\r\n\r\n";
  while (received_.find(kEnd) == std::string::npos) {
    if (!fill())
      return {};
  }
  const std::size_t end = received_.find(kEnd) + kEnd.size();
  RawReply reply = parse_reply_head(received_.substr(0, end));
  received_.erase(0, end);
  const auto length = reply.headers.find("content-length");
  if (is_head || length == reply.headers.end())
    return reply;
  const std::size_t bytes = std::stoull(length->second);
  while (received_.size() < bytes && fill()) {
  }
  reply.body = received_.substr(0, bytes);
  received_.erase(0, reply.body.size());
  return reply;
}

RawReply RawClient::get(const std::string& target, const std::string& more_headers) {
  send("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" + more_headers + "\r\n");
  return receive();
}

bool RawClient::is_closed() {
  return received_.empty() && !fill();
}

}  // namespace meshhier::tests
