// Materials as the journal keeps them.
#pragma once

#include "images/material_list.h"

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

nlohmann::json to_json(const images::MaterialList& list);
/// Parses what to_json() wrote. Throws nlohmann::json::exception if it is nothing of the kind.
images::MaterialList material_list(const nlohmann::json& json);

}  // namespace meshhier::pipeline
