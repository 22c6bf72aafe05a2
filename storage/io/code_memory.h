// Whether programs that compile while they run can run here.
#pragma once

namespace meshhier::storage {

/// Whether memory may be made executable, as Node.js needs. Services are kept from it by
/// MemoryDenyWriteExecute=yes of systemd, their child processes, too. Thread-safe.
bool may_make_code();

}  // namespace meshhier::storage
