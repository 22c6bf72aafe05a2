// Packed data for tests.
#pragma once

#include <string>
#include <string_view>

namespace meshhier::tests {

/// One gzip member that holds `content`.
std::string gzip(std::string_view content);

}  // namespace meshhier::tests
