// How much memory a test asks for: a program with this file counts all of its operator new.
#pragma once

#include <cstddef>

namespace meshhier::tests {

/// Bytes asked of operator new by the program so far, whatever was given back since.
std::size_t taken_bytes();
/// How often it asked.
std::size_t taken_count();

}  // namespace meshhier::tests
