// JSON for other programs: nothing of a name is lost.
#pragma once

#include "storage/io/json_text.h"

#include <string>

namespace meshhier::storage {

/// Returns the text of what is told to other programs. Beside each KEY of an object whose value is
/// no UTF-8, as the name of a file may be, it has KEY_escaped with the value's bytes as
/// percent_encoded() writes them; KEY has U+FFFD for what is none. Texts of arrays have no such
/// neighbour.
std::string told_json_text(const nlohmann::ordered_json& value, JsonLayout layout = {});

}  // namespace meshhier::storage
