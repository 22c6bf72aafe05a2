// A mesh file on its way to a hierarchy, as the page shows it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::server {

enum class JobState { waiting, building, failed };

struct Job {
  std::string name;  ///< of the mesh file
  JobState state = JobState::waiting;
  std::string stage{};                   ///< of the build at work: "partition"
  std::optional<double> progress{};      ///< of the stage, 0 to 1, if it is known
  std::optional<double> seconds_left{};  ///< of the stage
  std::string message{};                 ///< why it waits or failed
  std::vector<std::string> warnings{};   ///< of the build, each once, the first hundred
};

/// As in models.json; what is not known is left out.
nlohmann::ordered_json to_json(const Job& job);

/// Takes in one line of what `build --progress json` says; any other line is a message, too.
void take_line(Job& job, std::string_view line);

}  // namespace meshhier::server
