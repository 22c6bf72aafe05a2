#include "tests/support/http_host.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace meshhier::tests {
namespace {

HostRequest parse(const std::string& head) {
  HostRequest request;
  request.head = head;
  const std::size_t blank = head.find(' ');
  request.method = head.substr(0, blank);
  request.target = head.substr(blank + 1, head.find(' ', blank + 1) - blank - 1);
  constexpr std::string_view kRange = "\r\nRange: bytes=";
  if (const std::size_t at = head.find(kRange); at != std::string::npos) {
    std::size_t used = 0;
    const std::string text = head.substr(at + kRange.size());
    const std::uint64_t first = std::stoull(text, &used);
    request.range = {first, std::stoull(text.substr(used + 1))};
  }
  return request;
}

}  // namespace

HttpHost::HttpHost(Answer answer)
    : answer_(std::move(answer)), listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  if (bind(listener_, any, size) != 0 || listen(listener_, 64) != 0 ||
      getsockname(listener_, any, &size) != 0)
    throw std::runtime_error("no port for a host of the tests");
  port_ = ntohs(address.sin_port);
  accepting_ = std::thread([this] { accept_all(); });
}

HttpHost::~HttpHost() {
  is_over_ = true;
  shutdown(listener_, SHUT_RDWR);
  accepting_.join();
  close(listener_);
  std::vector<std::thread> threads;
  {
    const std::lock_guard lock(mutex_);
    for (const int connection : connections_)
      shutdown(connection, SHUT_RDWR);
    threads.swap(threads_);
  }
  for (std::thread& thread : threads)
    thread.join();
}

std::string HttpHost::url() const {
  return fmt::format("http://127.0.0.1:{}/", port_);
}

std::vector<std::string> HttpHost::heads() const {
  const std::lock_guard lock(mutex_);
  return heads_;
}

void HttpHost::accept_all() {
  for (;;) {
    const int connection = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0 || is_over_)
      return;
    const std::lock_guard lock(mutex_);
    connections_.push_back(connection);
    threads_.emplace_back([this, connection] { serve(connection); });
  }
}

void HttpHost::serve(int connection) {
  std::string text;
  for (bool goes_on = true; goes_on;) {
    std::size_t end = text.find("\r\n\r\n");
    if (end == std::string::npos) {
      char more[4096];
      const ssize_t count = recv(connection, more, sizeof(more), 0);
      if (count <= 0)
        break;
      text.append(more, static_cast<std::size_t>(count));
      continue;
    }
    const std::string head = text.substr(0, end + 2);
    text.erase(0, end + 4);
    {
      const std::lock_guard lock(mutex_);
      heads_.push_back(head);
    }
    const HostReply reply = answer_(parse(head));
    goes_on = reply.keeps_open;
    for (std::size_t sent = 0; sent < reply.bytes.size();) {
      const ssize_t count =
          send(connection, reply.bytes.data() + sent, reply.bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) {
        goes_on = false;
        break;
      }
      sent += static_cast<std::size_t>(count);
    }
  }
  const std::lock_guard lock(mutex_);
  std::erase(connections_, connection);
  close(connection);
}

HostReply answer_with(const HostRequest& request, const std::string& file,
                      const std::string& more_headers) {
  if (!request.range)
    return answer_whole(request, file);
  const auto [first, last] = *request.range;
  if (first >= file.size())
    return answer_status(416, fmt::format("Content-Range: bytes */{}\r\n", file.size()));
  const std::uint64_t end = std::min<std::uint64_t>(last + 1, file.size());
  return {fmt::format(
      "HTTP/1.1 206 Partial Content\r\nContent-Range: bytes {}-{}/{}\r\n"
      "Content-Length: {}\r\n{}\r\n{}",
      first, end - 1, file.size(), end - first, more_headers, file.substr(first, end - first))};
}

HostReply answer_whole(const HostRequest& request, const std::string& file) {
  return {fmt::format("HTTP/1.1 200 OK\r\nContent-Length: {}\r\n\r\n{}", file.size(),
                      request.method == "HEAD" ? "" : file)};
}

HostReply answer_status(int status, const std::string& more_headers) {
  constexpr std::string_view kSorry = "<html>sorry</html>";
  return {fmt::format("HTTP/1.1 {} Whatever\r\nContent-Length: {}\r\n{}\r\n{}", status,
                      kSorry.size(), more_headers, kSorry)};
}

}  // namespace meshhier::tests
