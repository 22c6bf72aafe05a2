// The files of an input as the journal keeps them.
#pragma once

#include "import/input_record.h"

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

nlohmann::json to_json(const importing::InputRecord& record);
/// Parses what to_json() wrote. Throws nlohmann::json::exception if it is nothing of the kind.
importing::InputRecord input_record(const nlohmann::json& json);

}  // namespace meshhier::pipeline
