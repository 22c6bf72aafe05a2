// The program that runs: where it is, and how to start it again.
//
// In the portable archive (packaging/portable/launcher.cpp) what runs is the loader that came with
// it: the launcher says by MESHHIER_PROGRAM where it lies itself. Without /proc the path counts by
// which the process was started.
#pragma once

#include <string>

namespace meshhier::storage {

/// As a path that starts it again, even if its file is not there any more.
std::string own_program();
/// Where its file lies. Throws Error(io).
std::string own_directory();
/// The file with its code, which tells one version from another: for reading.
std::string own_code();

}  // namespace meshhier::storage
