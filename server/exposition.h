// The text format of Prometheus, version 0.0.4: families of samples, each with its help.
#pragma once

#include <string>
#include <string_view>

namespace meshhier::server {

class Exposition {
 public:
  static constexpr const char* kContentType = "text/plain; version=0.0.4; charset=utf-8";

  enum class Kind { counter, gauge };
  /// Begins a family. `name` and `help` are ours: they have nothing to escape.
  void begin(Kind kind, std::string_view name, std::string_view help);
  /// Adds a sample of that family. `labels`: as they stand in the text, `method="GET"`; values are
  /// ours, too.
  void add(double value, std::string_view labels = {});
  /// A family of one sample.
  void add_one(Kind kind, std::string_view name, std::string_view help, double value);

  const std::string& text() const { return text_; }

 private:
  std::string name_, text_;
};

}  // namespace meshhier::server
