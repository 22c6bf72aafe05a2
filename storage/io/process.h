// This process: what it has used of the machine so far, and a place of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace meshhier::storage {

/// All threads together, since the process began.
struct ProcessUsage {
  double user_seconds = 0;
  double system_seconds = 0;
  std::uint64_t peak_resident_bytes = 0;  ///< the most memory that was resident at once,
                                          ///< as exact as the system counts: some 100 KiB
};

/// Thread-safe; some 20 microseconds. A figure that the system does not tell is 0.
ProcessUsage process_usage();

/// Memory that is resident now. Thread-safe; some 20 microseconds. 0 if the system does not tell.
std::uint64_t resident_bytes();

/// From now on the process may have as many files open as the system lets it.
void allow_many_open_files();

/// A name that no other process has used or will use, on any machine: for a file until it is whole.
/// Letters, digits and dashes.
std::string unique_name();
/// Whether it looks like one.
bool is_unique_name(std::string_view name);

/// The system's for temporary files: TMPDIR, else /tmp. Throws Error(io), which names it, if it is
/// no directory.
std::filesystem::path temporary_folder();

/// Makes a directory that only this user can enter, in the system's for temporary files. Throws
/// Error(io).
std::filesystem::path make_temporary_directory();

}  // namespace meshhier::storage
