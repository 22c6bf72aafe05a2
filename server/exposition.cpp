#include "server/exposition.h"

#include <fmt/format.h>

namespace meshhier::server {

void Exposition::begin(Kind kind, std::string_view name, std::string_view help) {
  name_ = name;
  text_ += fmt::format("# HELP {0} {1}\n# TYPE {0} {2}\n", name, help,
                       kind == Kind::counter ? "counter" : "gauge");
}

void Exposition::add(double value, std::string_view labels) {
  text_ += labels.empty() ? fmt::format("{} {}\n", name_, value)
                          : fmt::format("{}{{{}}} {}\n", name_, labels, value);
}

void Exposition::add_one(Kind kind, std::string_view name, std::string_view help, double value) {
  begin(kind, name, help);
  add(value);
}

}  // namespace meshhier::server
