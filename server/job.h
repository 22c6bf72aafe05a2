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
  std::string name;  ///< the mesh file's
  JobState state = JobState::waiting;
  std::string stage{};                   ///< the build is at: "partition"
  std::optional<double> progress{};      ///< the stage's, 0 to 1, if it is known
  std::optional<double> seconds_left{};  ///< until the end of the stage
  std::string message{};                 ///< why it waits or failed
  std::vector<std::string> warnings{};   ///< the build's, each once, the first hundred
};

/// Returns the object of models.json; unknown facts are left out.
nlohmann::ordered_json to_json(const Job& job);

/// Takes in one line that `build --progress json` prints; any other line is a message, too.
void take_line(Job& job, std::string_view line);

}  // namespace meshhier::server
