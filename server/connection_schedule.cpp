#include "server/connection_schedule.h"

#include <algorithm>
#include <utility>

namespace meshhier::server {
namespace {

/// A client may have so many threads for each that is free.
constexpr std::size_t kShare = 3;

}  // namespace

ConnectionSchedule::ConnectionSchedule(Size size, const ConnectionLimits& limits)
    : size_(size), limits_(limits) {}

ConnectionSchedule::Id ConnectionSchedule::add(PendingConnection connection) {
  pending_.emplace(next_id_, std::move(connection));
  return next_id_++;
}

bool ConnectionSchedule::has_next() const {
  return find_next() != pending_.end();
}

std::optional<PendingConnection> ConnectionSchedule::take_next() {
  const auto found = find_next();
  if (found == pending_.end())
    return std::nullopt;
  PendingConnection next = std::move(pending_.extract(found).mapped());
  ++all_served_;
  ++served_[next.client];
  return next;
}

void ConnectionSchedule::release(const std::string& client) {
  --all_served_;
  const auto found = served_.find(client);
  if (--found->second == 0)
    served_.erase(found);
}

bool ConnectionSchedule::must_yield(const std::string& client) const {
  // A client with more threads than this one has no claim on one of its.
  const std::size_t own = served_to(client);
  return std::any_of(pending_.begin(), pending_.end(), [&](const auto& entry) {
    const PendingConnection& other = entry.second;
    return other.is_ready && !may_serve(other) && served_to(other.client) <= own;
  });
}

bool ConnectionSchedule::make_room(Clock::time_point now) {
  if (pending_.size() + all_served_ < size_.connections)
    return true;
  const auto victim = find_victim();
  if (victim == pending_.end() || now - victim->second.since < limits_.patience)
    return false;
  pending_.erase(victim);
  ++refused_;
  return true;
}

bool ConnectionSchedule::drop_timed_out(Clock::time_point now) {
  return std::erase_if(pending_, [&](const auto& entry) {
           const PendingConnection& pending = entry.second;
           const auto limit = pending.has_begun ? limits_.head : limits_.idle;
           return !pending.is_ready && now - pending.since >= limit;
         }) > 0;
}

std::size_t ConnectionSchedule::served_to(const std::string& client) const {
  const auto found = served_.find(client);
  return found == served_.end() ? 0 : found->second;
}

bool ConnectionSchedule::may_serve(const PendingConnection& connection) const {
  const std::size_t free = size_.threads - all_served_;
  return connection.is_ready && served_to(connection.client) < kShare * free;
}

ConnectionSchedule::Pending::const_iterator ConnectionSchedule::find_next() const {
  return std::find_if(pending_.begin(), pending_.end(),
                      [this](const auto& entry) { return may_serve(entry.second); });
}

ConnectionSchedule::Pending::const_iterator ConnectionSchedule::find_victim() const {
  std::map<std::string, std::size_t> counts = served_;
  for (const auto& [id, connection] : pending_)
    ++counts[connection.client];
  auto victim = pending_.end();
  std::size_t most = 0;
  for (auto entry = pending_.begin(); entry != pending_.end(); ++entry) {
    const std::size_t count = counts[entry->second.client];
    if (!entry->second.is_ready && count > most) {
      most = count;
      victim = entry;
    }
  }
  return victim;
}

}  // namespace meshhier::server
