// A form of files as a client sends it.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace meshhier::tests {

inline const std::string kBoundary = "----WebKitFormBoundary7MA4YWxkTrZu0gW";

using FormFiles = std::vector<std::pair<std::string, std::string>>;  ///< names and contents

inline std::string form_text(const FormFiles& files) {
  std::string text;
  for (const auto& [name, content] : files) {
    text += "--" + kBoundary + "\r\nContent-Disposition: form-data; name=\"file\"; filename=\"" +
            name + "\"\r\nContent-Type: application/octet-stream\r\n\r\n" + content + "\r\n";
  }
  return text + "--" + kBoundary + "--\r\n";
}

}  // namespace meshhier::tests
