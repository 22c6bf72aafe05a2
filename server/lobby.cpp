#include "server/lobby.h"

#include "hierarchy/error.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace meshhier::server {
namespace {

/// How long it may not be noticed that somebody is late.
constexpr std::chrono::milliseconds kLateFor{50};

/// What an address may have for each that is free.
constexpr std::size_t kShare = 3;

int make_bell() {
  const int bell = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (bell < 0)
    throw Error(ErrorCode::io, "cannot make an event counter");
  return bell;
}

}  // namespace

Lobby::Lobby(Size size, const ConnectionLimits& limits)
    : size_(size), limits_(limits), bell_(make_bell()), thread_([this] { watch(); }) {}

Lobby::~Lobby() {
  close();
  thread_.join();
  ::close(bell_);
}

void Lobby::enter(std::unique_ptr<Connection> connection) {
  std::unique_lock lock(mutex_);
  ++at_the_door_;
  while (!is_closed_ && !make_place())
    has_place_.wait_for(lock, kLateFor);
  --at_the_door_;
  add(std::move(connection));
}

void Lobby::come_back(std::unique_ptr<Connection> connection) {
  leave(connection->address());
  const std::lock_guard lock(mutex_);
  add(std::move(connection));
}

void Lobby::add(std::unique_ptr<Connection> connection) {
  if (is_closed_)
    return;
  Guest& guest = guests_[next_id_++];
  guest.connection = std::move(connection);
  guest.since = Clock::now();
  hear(guest);
  wake();
}

std::unique_ptr<Connection> Lobby::next() {
  std::unique_lock lock(mutex_);
  auto found = guests_.end();
  has_ready_.wait(lock, [&] { return is_closed_ || (found = find_ready()) != guests_.end(); });
  if (is_closed_)
    return nullptr;
  auto connection = std::move(found->second.connection);
  guests_.erase(found);
  --ready_;
  ++all_served_;
  ++served_[connection->address()];
  return connection;
}

void Lobby::leave(const std::string& address) {
  const std::lock_guard lock(mutex_);
  --all_served_;
  if (--served_[address] == 0)
    served_.erase(address);
  has_place_.notify_one();
  has_ready_.notify_all();
}

bool Lobby::is_crowded() const {
  const std::lock_guard lock(mutex_);
  return ready_ > 0 || at_the_door_ > 0;
}

std::size_t Lobby::served() const {
  const std::lock_guard lock(mutex_);
  return all_served_;
}

void Lobby::close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  guests_.clear();
  has_ready_.notify_all();
  has_place_.notify_all();
  wake();
}

/// Takes in what it has said by now.
void Lobby::hear(Guest& guest) {
  guest.is_ready = guest.connection->take_in();
  if (!guest.has_begun && guest.connection->has_begun()) {
    guest.has_begun = true;
    guest.since = Clock::now();
  }
  if (!guest.is_ready)
    return;
  ++ready_;
  has_ready_.notify_all();
}

void Lobby::watch() {
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (is_closed_)
        return;
      drop_the_late();
    }
    hear_those_who_speak();
  }
}

/// Who is polled may be gone when it is over: they are looked up again by their numbers.
void Lobby::hear_those_who_speak() {
  std::vector<pollfd> sockets{{bell_, POLLIN, 0}};
  std::vector<std::uint64_t> ids{0};
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, guest] : guests_) {
      if (guest.is_ready)
        continue;
      sockets.push_back({guest.connection->socket(), POLLIN, 0});
      ids.push_back(id);
    }
  }
  if (::poll(sockets.data(), sockets.size(), static_cast<int>(kLateFor.count())) <= 0)
    return;
  eventfd_t rung = 0;
  ::eventfd_read(bell_, &rung);
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 1; i < sockets.size(); ++i) {
    const auto found = sockets[i].revents == 0 ? guests_.end() : guests_.find(ids[i]);
    if (found != guests_.end() && !found->second.is_ready)
      hear(found->second);
  }
}

void Lobby::drop_the_late() {
  const Clock::time_point now = Clock::now();
  const std::size_t erased = std::erase_if(guests_, [&](const auto& entry) {
    const Guest& guest = entry.second;
    return !guest.is_ready && now - guest.since >= (guest.has_begun ? limits_.head : limits_.idle);
  });
  if (erased > 0)
    has_place_.notify_all();
}

/// False if nobody has waited too long.
bool Lobby::make_place() {
  if (guests_.size() + all_served_ < size_.connections)
    return true;
  const auto victim = find_victim();
  if (victim == guests_.end() || Clock::now() - victim->second.since < limits_.patience)
    return false;
  guests_.erase(victim);
  return true;
}

Lobby::Guests::iterator Lobby::find_victim() {
  std::map<std::string, std::size_t> counts = served_;
  for (const auto& [id, guest] : guests_)
    ++counts[guest.connection->address()];
  auto victim = guests_.end();
  std::size_t most = 0;
  for (auto guest = guests_.begin(); guest != guests_.end(); ++guest) {
    const std::size_t count = counts[guest->second.connection->address()];
    if (!guest->second.is_ready && count > most) {
      most = count;
      victim = guest;
    }
  }
  return victim;
}

/// Whoever came first, of the addresses that may have another thread.
Lobby::Guests::iterator Lobby::find_ready() {
  const std::size_t free = size_.threads - all_served_;
  return std::find_if(guests_.begin(), guests_.end(), [&](const auto& entry) {
    if (!entry.second.is_ready)
      return false;
    const auto found = served_.find(entry.second.connection->address());
    return found == served_.end() || found->second < kShare * free;
  });
}

void Lobby::wake() const {
  ::eventfd_write(bell_, 1);
}

}  // namespace meshhier::server
