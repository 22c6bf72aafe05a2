#include "server/connection.h"

#include "server/client_key.h"
#include "server/line_ends.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace meshhier::server {
namespace {

/// A thread notices after so long that the server stops, or that others wait.
constexpr std::chrono::milliseconds kSlice{100};

/// finish() drops so many bytes at the most, and for so long.
constexpr std::size_t kMostDropped = 256 * 1024;
constexpr std::chrono::milliseconds kDropTime{200};

/// Returns an address, "127.0.0.1"; empty if it is not known.
template <class Ask>
std::string address_of(socket_t socket, const Ask& ask) {
  sockaddr_storage address{};
  socklen_t bytes = sizeof(address);
  std::array<char, NI_MAXHOST> text{};
  auto* const place = reinterpret_cast<sockaddr*>(&address);
  if (ask(socket, place, &bytes) != 0 ||
      ::getnameinfo(place, bytes, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) != 0)
    return {};
  return text.data();
}

}  // namespace

Connection::Connection(socket_t socket, const ConnectionLimits& limits, MustYield must_yield,
                       std::function<bool()> is_stopping, Sent sent)
    : socket_(socket),
      address_(address_of(socket, ::getpeername)),
      client_(client_key(address_)),
      limits_(limits),
      must_yield_(std::move(must_yield)),
      is_stopping_(std::move(is_stopping)),
      sent_(std::move(sent)) {}

Connection::~Connection() {
  ::close(socket_);
}

bool Connection::wait(short event, Clock::time_point end,
                      const std::function<bool()>& is_over) const {
  for (;;) {
    pollfd ready{socket_, event, 0};
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
    const auto slice = std::clamp(left, std::chrono::milliseconds{0}, kSlice);
    const int count = ::poll(&ready, 1, static_cast<int>(slice.count()));
    if (count > 0)
      return true;
    if ((count < 0 && errno != EINTR) || Clock::now() >= end || is_over())
      return false;
  }
}

Connection::Received Connection::receive() {
  std::array<char, 4096> buffer;
  const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (count > 0) {
    received_.append(buffer.data(), static_cast<std::size_t>(count));
    return Received::something;
  }
  const bool may_go_on = count < 0 && (errno == EAGAIN || errno == EINTR);
  return may_go_on ? Received::nothing_yet : Received::end;
}

/// Returns where the next head begins in received_: behind an empty line, which some clients send
/// behind a body (RFC 9112, section 2.2).
std::size_t Connection::head_begin() const {
  return received_.starts_with(kLineEnd) ? kLineEnd.size() : 0;
}

bool Connection::has_begun() const {
  return received_.size() > head_begin();
}

bool Connection::has_head() const {
  return received_.find(kHeadEnd, head_begin()) != std::string::npos ||
         received_.size() > kMostHeadBytes;
}

bool Connection::read_available() {
  while (!has_head()) {
    const Received received = receive();
    has_ended_ = received == Received::end;
    if (received != Received::something)
      return has_ended_;
  }
  return true;
}

void Connection::begin_exchange() {
  exchange_start_ = Clock::now();
  exchanged_bytes_ = 0;
}

Connection::Next Connection::refuse(RefusedHead refusal) {
  refusal_ = std::move(refusal);
  return Next::refused;
}

Connection::Next Connection::next_request() {
  begin_exchange();  // also if there is no request: a refusal is a reply
  has_unread_ = has_begun();
  received_.erase(0, head_begin());
  const std::size_t found = received_.find(kHeadEnd);
  const std::size_t bytes = found == std::string::npos ? 0 : found + kHeadEnd.size();
  if (bytes > kMostHeadBytes || received_.size() - bytes > kMostHeadBytes)
    return refuse(refuse_size(received_));
  if (bytes == 0)
    return Next::end;
  auto head = parse_head(std::string_view(received_).substr(0, bytes));
  if (auto* refused = std::get_if<RefusedHead>(&head))
    return refuse(std::move(*refused));
  head_ = std::get<RequestHead>(std::move(head));
  received_.erase(0, bytes);
  has_unread_ = head_.has_body || has_begun();
  body_left_ = head_.body_bytes.value_or(0);
  place_ = 0;
  ++requests_;
  begin_exchange();
  return Next::request;
}

ssize_t Connection::read(char* bytes, std::size_t count) {
  const std::size_t taken = std::min(count, head_.text.size() - place_);
  std::memcpy(bytes, head_.text.data() + place_, taken);
  place_ += taken;
  return static_cast<ssize_t>(taken);
}

std::size_t Connection::take_received(std::span<std::byte> bytes) {
  const std::size_t taken = std::min(bytes.size(), received_.size());
  std::memcpy(bytes.data(), received_.data(), taken);
  received_.erase(0, taken);
  return taken;
}

bool Connection::invite_body() {
  if (!std::exchange(head_.expects_continue, false))
    return true;
  constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
  return write(kContinue.data(), kContinue.size()) == static_cast<ssize_t>(kContinue.size());
}

Connection::BodyPiece Connection::receive_body(std::span<std::byte> bytes) {
  if (!invite_body())
    return {0, Body::End::lost};
  while (!is_stopping_()) {
    if (is_too_slow() || !wait(POLLIN, Clock::now() + limits_.stall, is_stopping_))
      return {0, is_stopping_() ? Body::End::stopping : Body::End::slow};
    const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count > 0)
      return {static_cast<std::size_t>(count)};
    if (count == 0 || (errno != EAGAIN && errno != EINTR))
      return {0, Body::End::lost};
  }
  return {0, Body::End::stopping};
}

Connection::BodyPiece Connection::take_body(std::span<std::byte> bytes) {
  const auto most = static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), body_left_));
  if (most == 0)
    return {};
  BodyPiece piece{take_received(bytes.first(most))};
  if (piece.bytes == 0)
    piece = receive_body(bytes.first(most));
  body_left_ -= piece.bytes;
  exchanged_bytes_ += piece.bytes;
  if (body_left_ == 0) {
    has_unread_ = has_begun();
    begin_exchange();
  }
  return piece;
}

bool Connection::is_too_slow() const {
  const auto time = Clock::now() - exchange_start_;
  const double seconds = std::chrono::duration<double>(time).count();
  return time > limits_.grace &&
         static_cast<double>(exchanged_bytes_) <
             seconds * static_cast<double>(limits_.least_rate) &&
         must_yield_(client_);
}

ssize_t Connection::write(const char* bytes, std::size_t count) {
  if (is_broken_ || is_too_slow() || !wait(POLLOUT, Clock::now() + limits_.stall, is_stopping_)) {
    is_broken_ = true;
    return -1;
  }
  const ssize_t sent = ::send(socket_, bytes, count, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent < 0 && (errno == EAGAIN || errno == EINTR))
    return 0;
  is_broken_ = sent < 0;
  if (is_broken_)
    return sent;
  exchanged_bytes_ += static_cast<std::size_t>(sent);
  sent_(static_cast<std::size_t>(sent));
  return sent;
}

void Connection::finish() {
  if (!has_unread_)
    return;
  ::shutdown(socket_, SHUT_WR);
  const Clock::time_point end = Clock::now() + kDropTime;
  std::size_t dropped = 0;
  while (dropped < kMostDropped && wait(POLLIN, end, is_stopping_)) {
    received_.clear();
    if (receive() == Received::end)
      break;
    dropped += received_.size();
  }
}

void Connection::get_remote_ip_and_port(std::string& ip, int&) const {
  ip = address_;
}

void Connection::get_local_ip_and_port(std::string& ip, int&) const {
  ip = address_of(socket_, ::getsockname);
}

}  // namespace meshhier::server
