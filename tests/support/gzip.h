// Packed data for tests.
#pragma once

#include <string>
#include <string_view>

namespace meshhier::tests {

/// One gzip member that holds `content`.
std::string gzip(std::string_view content);
/// Returns the content of one gzip member.
std::string gunzip(const std::string& packed);

}  // namespace meshhier::tests
