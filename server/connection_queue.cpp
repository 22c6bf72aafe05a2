#include "server/connection_queue.h"

#include "base/error.h"

#include <new>
#include <optional>
#include <utility>
#include <vector>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace meshhier::server {
namespace {

/// A time limit may be noticed so late.
constexpr std::chrono::milliseconds kPollTime{50};

int make_wakeup_fd() {
  const int descriptor = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (descriptor < 0)
    throw Error(ErrorCode::io, "cannot make an event counter");
  return descriptor;
}

}  // namespace

ConnectionQueue::ConnectionQueue(ConnectionSchedule::Size size, const ConnectionLimits& limits)
    : schedule_(size, limits), wakeup_fd_(make_wakeup_fd()), thread_([this] { watch(); }) {}

ConnectionQueue::~ConnectionQueue() {
  close();
  thread_.join();
  ::close(wakeup_fd_);
}

void ConnectionQueue::accept(std::unique_ptr<Connection> connection) {
  std::unique_lock lock(mutex_);
  ++waiting_accepts_;
  while (!is_closed_ && !schedule_.make_room(Clock::now()))
    has_room_.wait_for(lock, kPollTime);
  --waiting_accepts_;
  add(std::move(connection));
}

std::unique_ptr<Connection> ConnectionQueue::next() {
  std::unique_lock lock(mutex_);
  std::optional<PendingConnection> next;
  has_next_.wait(lock, [&] { return is_closed_ || (next = schedule_.take_next()); });
  if (!next)
    return nullptr;
  offer_next();
  return std::move(next->connection);
}

void ConnectionQueue::return_connection(std::unique_ptr<Connection> connection) {
  const std::lock_guard lock(mutex_);
  schedule_.release(connection->client());
  add(std::move(connection));
}

void ConnectionQueue::close_connection(std::unique_ptr<Connection> connection) {
  const std::string client = connection->client();
  connection.reset();
  const std::lock_guard lock(mutex_);
  schedule_.release(client);
  has_room_.notify_one();
  offer_next();
}

bool ConnectionQueue::has_waiting_accepts() const {
  const std::lock_guard lock(mutex_);
  return waiting_accepts_ > 0;
}

bool ConnectionQueue::must_yield(const std::string& client) const {
  const std::lock_guard lock(mutex_);
  return waiting_accepts_ > 0 || schedule_.must_yield(client);
}

ConnectionQueue::Load ConnectionQueue::load() const {
  const std::lock_guard lock(mutex_);
  return {schedule_.pending().size(), schedule_.served(), schedule_.refused()};
}

void ConnectionQueue::close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  schedule_.pending().clear();
  has_next_.notify_all();
  has_room_.notify_all();
  wake_poll();
}

void ConnectionQueue::add(std::unique_ptr<Connection> connection) {
  if (is_closed_)
    return;
  PendingConnection pending{.connection = std::move(connection), .since = Clock::now()};
  pending.client = pending.connection->client();
  read_available(pending);
  schedule_.add(std::move(pending));
  offer_next();
  wake_poll();
}

void ConnectionQueue::read_available(PendingConnection& pending) {
  pending.is_ready = pending.connection->read_available();
  if (pending.has_begun || !pending.connection->has_begun())
    return;
  pending.has_begun = true;
  pending.since = Clock::now();
}

/// Wakes one thread, which is enough: whoever takes a connection offers the next one. A thread that
/// is busy now looks for itself when it comes back.
void ConnectionQueue::offer_next() {
  if (schedule_.has_next())
    has_next_.notify_one();
}

void ConnectionQueue::watch() {
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (is_closed_)
        return;
      if (schedule_.drop_timed_out(Clock::now()))
        has_room_.notify_one();
    }
    try {
      poll_pending();
    } catch (const std::bad_alloc&) {  // perhaps there is some in a moment
      std::this_thread::sleep_for(kPollTime);
    }
  }
}

/// Waits for bytes of pending connections and reads them. Connections may be gone after poll():
/// they are looked up again by their ids.
void ConnectionQueue::poll_pending() {
  std::vector<pollfd> sockets{{wakeup_fd_, POLLIN, 0}};
  std::vector<ConnectionSchedule::Id> ids{0};
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, pending] : schedule_.pending()) {
      if (pending.is_ready)
        continue;
      sockets.push_back({pending.connection->socket(), POLLIN, 0});
      ids.push_back(id);
    }
  }
  // Without the lock: others take and add connections meanwhile, and wake this thread for new ones.
  if (::poll(sockets.data(), sockets.size(), static_cast<int>(kPollTime.count())) <= 0)
    return;
  eventfd_t count = 0;
  ::eventfd_read(wakeup_fd_, &count);
  const std::lock_guard lock(mutex_);
  auto& pending = schedule_.pending();
  for (std::size_t i = 1; i < sockets.size(); ++i) {
    const auto found = sockets[i].revents == 0 ? pending.end() : pending.find(ids[i]);
    if (found != pending.end() && !found->second.is_ready)
      read_available(found->second);
  }
  offer_next();
}

void ConnectionQueue::wake_poll() const {
  ::eventfd_write(wakeup_fd_, 1);
}

}  // namespace meshhier::server
