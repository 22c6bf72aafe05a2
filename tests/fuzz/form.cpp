// A form of files: one byte for the size of the pieces it comes in, a line with its Content-Type,
// then its body.
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "server/multipart.h"
#include "tests/server/text_body.h"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::tests::fuzz {
namespace {

using server::MultipartReader;

struct Form {
  bool is_whole = false;
  std::vector<std::pair<std::string, std::string>> files;  ///< names and contents
  friend bool operator==(const Form&, const Form&) = default;
};

/// As far as it can be read.
Form read_form(const std::string& body_text, const std::string& boundary, std::size_t piece) {
  TextBody body(body_text, {.most_at_once = piece});
  MultipartReader reader(body, boundary);
  Form form;
  auto next = reader.next();
  std::vector<std::byte> bytes(piece);
  for (; next == MultipartReader::Next::file; next = reader.next()) {
    form.files.emplace_back(reader.name(), "");
    while (const std::size_t count = reader.read(bytes))
      form.files.back().second.append(reinterpret_cast<const char*>(bytes.data()), count);
  }
  form.is_whole = next == MultipartReader::Next::end;
  return form;
}

void check_files(const Form& form, std::string_view rest, const std::string& delimiter) {
  for (const auto& [name, content] : form.files) {
    require(rest.find(name) != std::string_view::npos, "names were sent");
    const std::size_t found = rest.find(content);
    require(found != std::string_view::npos, "contents were sent, one behind the other");
    rest.remove_prefix(found + content.size());
    require(content.find(delimiter) == std::string::npos, "no content goes beyond its part");
  }
}

}  // namespace

void form(Bytes input) {
  std::string_view text = text_of(input);
  if (text.empty())
    return;
  const std::size_t piece = static_cast<unsigned char>(text.front()) + std::size_t{1};
  const std::string_view type = text.substr(1, std::min(text.find('\n', 1), text.size()) - 1);
  const std::optional<std::string> boundary = server::form_boundary(type);
  if (!boundary)
    return;
  require(!boundary->empty() && boundary->size() <= 70, "a boundary is short");
  const std::string body(text.substr(std::min(type.size() + 2, text.size())));
  const Form whole = read_form(body, *boundary, std::size_t{1} << 18);
  require(read_form(body, *boundary, piece) == whole, "a form is one however it comes");
  check_files(whole, body, "\r\n--" + *boundary);
}

}  // namespace meshhier::tests::fuzz
