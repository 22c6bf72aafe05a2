#include "execution/memory_budget.h"

#include "base/named_value.h"
#include "execution/size_text.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace meshhier::execution {
namespace {

using storage::MemoryBound;

constexpr std::uint64_t kBudgetGrain = std::uint64_t{1} << 20;

constexpr std::array kBounds{NamedValue{"the machine has", MemoryBound::machine},
                             NamedValue{"ulimit -v allows", MemoryBound::address_space},
                             NamedValue{"ulimit -d allows", MemoryBound::data},
                             NamedValue{"the control group allows", MemoryBound::group}};

}  // namespace

std::uint64_t most_budget(const storage::UsableMemory& usable) {
  return std::max(usable.bytes / 4 * 3 / kBudgetGrain, std::uint64_t{1}) * kBudgetGrain;
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
