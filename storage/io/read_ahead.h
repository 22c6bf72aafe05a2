// Values that will be asked for soon, loaded by threads of its own before they are: for what comes
// from far.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace meshhier::storage {

/// Loads values by key, in the order in which they are announced. Thread-safe. The destructor waits
/// for loads that are under way.
template <class Key, class Value>
class ReadAhead {
 public:
  using Load = std::function<Value(const Key&)>;
  using Cost = std::function<std::uint64_t(const Value&)>;

  /// `load` is called by up to `threads` threads at once. They begin no load while what they have
  /// loaded and nobody has taken costs `most` or more. No thread runs before something is
  /// announced.
  ReadAhead(std::size_t threads, std::uint64_t most, Load load, Cost cost)
      : threads_(threads), most_(most), load_(std::move(load)), cost_(std::move(cost)) {}
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;
  ~ReadAhead() {
    {
      const std::lock_guard lock(mutex_);
      for (std::jthread& worker : workers_)
        worker.request_stop();
    }
    changed_.notify_all();
  }

  /// Announces keys; they replace those that were announced before and are not begun.
  void announce(std::vector<Key> keys) {
    const std::lock_guard lock(mutex_);
    std::erase_if(items_, [](const Item& item) { return item.state == State::waiting; });
    for (Key& key : keys)
      items_.push_back({std::move(key)});
    add_workers();
    changed_.notify_all();
  }

  /// Returns the value of the first announced key for which `is_it(key)`, once it is loaded; loads
  /// it in this thread if nobody has begun. Returns nothing if no such key is announced. Throws
  /// what `load` has thrown.
  template <class IsIt>
  std::optional<Value> take(const IsIt& is_it) {
    std::unique_lock lock(mutex_);
    const auto found = std::find_if(items_.begin(), items_.end(), [&](const Item& item) {
      return !item.is_taken && is_it(item.key);
    });
    if (found == items_.end())
      return std::nullopt;
    found->is_taken = true;
    drop_before(found);
    if (found->state == State::waiting)
      load(*found, lock);
    changed_.wait(lock, [&] { return found->state == State::there; });
    std::optional<Value> value = std::move(found->value);
    const std::exception_ptr failure = found->failure;
    spent_ -= found->cost;
    items_.erase(found);
    lock.unlock();
    changed_.notify_all();
    if (failure)
      std::rethrow_exception(failure);
    return value;
  }

 private:
  enum class State : std::uint8_t { waiting, loading, there };
  struct Item {
    Key key;
    State state = State::waiting;
    std::optional<Value> value{};
    std::exception_ptr failure{};
    std::uint64_t cost = 0;
    bool is_taken = false;  ///< somebody waits for it
  };
  using Items = std::list<Item>;

  /// Keys that takers have passed over will not be asked for: all but so many are dropped. Some are
  /// kept, as several threads take at once.
  static constexpr std::ptrdiff_t kSlack = 64;

  void drop_before(typename Items::iterator place) {
    std::ptrdiff_t before = std::distance(items_.begin(), place);
    for (auto item = items_.begin(); item != place && before > kSlack; --before) {
      if (item->state == State::loading || item->is_taken) {
        ++item;
        continue;
      }
      spent_ -= item->cost;
      item = items_.erase(item);
    }
  }

  void load(Item& item, std::unique_lock<std::mutex>& lock) {
    item.state = State::loading;
    lock.unlock();
    std::optional<Value> value;
    std::exception_ptr failure;
    try {
      value.emplace(load_(item.key));
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    item.cost = value ? cost_(*value) : 0;
    item.value = std::move(value);
    item.failure = failure;
    item.state = State::there;
    spent_ += item.cost;
    changed_.notify_all();
  }

  /// Starts as many threads as are of use and to be had. Fewer do no harm: who takes what nobody
  /// has begun loads it.
  void add_workers() {
    try {
      while (workers_.size() < std::min(threads_, items_.size()))
        workers_.emplace_back([this](const std::stop_token& stop) { work(stop); });
    } catch (const std::system_error&) {
      threads_ = workers_.size();
    }
  }

  typename Items::iterator next_waiting() {
    return std::find_if(items_.begin(), items_.end(),
                        [](const Item& item) { return item.state == State::waiting; });
  }

  void work(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    for (;;) {
      typename Items::iterator item;
      changed_.wait(lock, [&] {
        item = next_waiting();
        return stop.stop_requested() || (item != items_.end() && spent_ < most_);
      });
      if (stop.stop_requested())
        return;
      load(*item, lock);
    }
  }

  std::size_t threads_;
  std::uint64_t most_;
  Load load_;
  Cost cost_;
  std::mutex mutex_;  ///< guards all below
  std::condition_variable changed_;
  Items items_;
  std::uint64_t spent_ = 0;            ///< on what is there
  std::vector<std::jthread> workers_;  ///< ends first
};

}  // namespace meshhier::storage
