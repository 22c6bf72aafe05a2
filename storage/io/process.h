// This process: its use of the machine so far, and a place for its temporary files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace meshhier::storage {

/// The use by all threads together, since the process began.
struct ProcessUsage {
  double user_seconds = 0;
  double system_seconds = 0;
  std::uint64_t peak_resident_bytes = 0;  ///< the most memory that was resident at once,
                                          ///< as exact as the system counts: some 100 KiB
};

/// Returns the use so far. Thread-safe; takes some 20 microseconds. A figure that the system does
/// not tell is 0.
ProcessUsage process_usage();

/// Returns the memory that is resident now; 0 if the system does not tell. Thread-safe; takes some
/// 20 microseconds.
std::uint64_t resident_bytes();

/// Raises the number of files that the process may have open to as many as the system allows.
void allow_many_open_files();

/// Returns a name that no other call in any process on any machine returns: for a file until it is
/// whole. Lower-case letters, digits and dashes. Thread-safe.
std::string unique_name();
/// Whether a name has the form of those that unique_name() returns.
bool is_unique_name(std::string_view name);

/// Returns the system's directory for temporary files: TMPDIR, else /tmp. Throws Error(io), which
/// names it, if it is no directory.
std::filesystem::path temporary_folder();

/// Makes a new directory that only this user can enter, in temporary_folder(), and returns its
/// path. The caller removes it. Throws Error(io).
std::filesystem::path make_temporary_directory();

}  // namespace meshhier::storage
