#include "execution/memory_budget.h"

#include "base/named_value.h"
#include "execution/size_text.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace meshhier::execution {
namespace {

using storage::MemoryBound;

constexpr std::uint64_t kBudgetGrain = std::uint64_t{1} << 20;  // messages tell it: "6026MiB"
constexpr std::uint64_t kLeastDefault = std::uint64_t{512} << 20;
constexpr std::uint64_t kMostDefault = std::uint64_t{16} << 30;

constexpr std::array kBounds{NamedValue{"the machine has", MemoryBound::machine},
                             NamedValue{"ulimit -v allows", MemoryBound::address_space},
                             NamedValue{"ulimit -d allows", MemoryBound::data},
                             NamedValue{"the control group allows", MemoryBound::group}};

std::uint64_t whole_mib(std::uint64_t bytes) {
  return bytes / kBudgetGrain * kBudgetGrain;
}

}  // namespace

std::uint64_t default_budget(const storage::UsableMemory& usable) {
  return std::min(std::clamp(whole_mib(usable.bytes / 4), kLeastDefault, kMostDefault),
                  most_budget(usable));
}

std::uint64_t most_budget(const storage::UsableMemory& usable) {
  return std::max(whole_mib(usable.bytes / 4 * 3), kBudgetGrain);
}

std::string budget_warning(std::string_view name, std::uint64_t budget_bytes,
                           const storage::UsableMemory& usable) {
  if (budget_bytes <= usable.bytes)
    return {};
  return fmt::format(
      "{} {} is more than the {} that {}: the system may end this process; set at "
      "most {}",
      name, exact_size_text(budget_bytes), rounded_size_text(usable.bytes),
      name_in(kBounds, usable.bound), exact_size_text(most_budget(usable)));
}

}  // namespace meshhier::execution
