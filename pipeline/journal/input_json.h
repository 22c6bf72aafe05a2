// The input's files and materials as the journal keeps them.
#pragma once

#include "images/material_list.h"
#include "import/input_record.h"

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

nlohmann::json to_json(const importing::InputRecord& record);
nlohmann::json to_json(const images::MaterialList& list);

/// Parse what to_json() wrote. Throw nlohmann::json::exception if it is nothing of the kind.
importing::InputRecord input_record(const nlohmann::json& json);
images::MaterialList material_list(const nlohmann::json& json);

}  // namespace meshhier::pipeline
