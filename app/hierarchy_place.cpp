#include "app/hierarchy_place.h"

#include "app/options.h"
#include "base/error.h"
#include "base/plain_text.h"
#include "base/small_letters.h"
#include "base/text_mark.h"
#include "base/trimmed.h"
#include "execution/size_text.h"
#include "storage/io/http_token.h"
#include "storage/io/process.h"
#include "storage/io/web_address.h"

#include <algorithm>
#include <random>
#include <ranges>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

namespace meshhier::app {
namespace {

/// The most bytes of a file with headers.
constexpr std::uint64_t kMostHeaderBytes = 65536;

/// A header goes to the host as it is: a line that is none could say something else there. Its
/// value may be a secret: no message has it.
void require_header(const std::string& line) {
  const std::size_t colon = line.find(':');
  const std::string name = small_letters(line.substr(0, colon));
  const bool is_address = name == "http" || name == "https";  // misspelt: it is for another host
  const bool is_line = std::ranges::none_of(
      line, [](char c) { return static_cast<unsigned char>(c) < ' ' && c != '\t'; });
  if (colon == std::string::npos || is_address || !storage::is_http_token(name) || !is_line) {
    throw Error(
        ErrorCode::usage,
        "--header: expected \"NAME: VALUE\", \"HOST NAME: VALUE\", or @FILE with such lines");
  }
}

/// Whether a word with something behind it names a host, "https://b.org", "b.org", "localhost:80":
/// a header begins with its name and a colon, or has neither dot nor number there.
bool is_host(std::string_view word) {
  const auto begins_port = [](char a, char b) { return a == ':' && b >= '0' && b <= '9'; };
  if (word.find(':') + 1 == word.size())
    return false;
  return storage::is_web_address(word) || word.find('.') != std::string_view::npos ||
         std::ranges::adjacent_find(word, begins_port) != word.end();
}

/// A header, and the host that it is for; none: that of the first address that is given.
struct Header {
  std::string host, line;
};

/// Parses "NAME: VALUE" or "HOST NAME: VALUE". A host before a blank is never taken for a header's
/// name: what is meant for it would go to another one.
Header parse_header(const std::string& line) {
  constexpr std::string_view kBlanks = " \t";
  const std::string_view text = trimmed(line, kBlanks);
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  Header header;
  if (word.size() < text.size() && is_host(word))
    header.host = word;
  header.line = trimmed(text.substr(header.host.size()), kBlanks);
  require_header(header.line);
  return header;
}

/// Whether an address is of that host; of either scheme if it names none.
bool is_of_host(const std::string& host, const std::string& address) {
  if (storage::is_web_address(host))
    return storage::is_same_host(host, address);
  return storage::is_same_host("http://" + host, address) ||
         storage::is_same_host("https://" + host, address);
}

/// Whether the header is for the host of `address`, which is one of `all`.
bool is_header_for(const Header& header, const std::string& address,
                   const std::vector<std::string>& all) {
  if (header.host.empty())
    return storage::is_same_host(all.front(), address);
  const auto is_its_host = [&](const std::string& other) { return is_of_host(header.host, other); };
  if (std::ranges::none_of(all, is_its_host)) {
    throw Error(ErrorCode::usage,
                "--header: a line is for a host that no address here names; \"NAME: VALUE\" has a "
                "blank behind the colon");
  }
  return is_its_host(address);
}

std::vector<std::string> lines_of(storage::FileSystem& files, const std::string& file) {
  const auto bytes = storage::read_file(files, file, kMostHeaderBytes);
  std::istringstream text(
      std::string(without_mark({reinterpret_cast<const char*>(bytes.data()), bytes.size()})));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    if (line.ends_with('\r'))
      line.pop_back();
    if (!line.empty())
      lines.push_back(line);
  }
  return lines;
}

storage::HttpOptions http_options(storage::FileSystem& files, const WebOptions& web,
                                  const std::string& address) {
  storage::HttpOptions options{{}, web.bytes_per_second};
  const std::vector<std::string> all = web.addresses.empty() ? std::vector{address} : web.addresses;
  for (const std::string& header : web.headers) {
    const std::vector<std::string> lines = header.starts_with('@')
                                               ? lines_of(files, header.substr(1))
                                               : std::vector<std::string>{header};
    for (const Header& parsed : lines | std::views::transform(parse_header)) {
      if (is_header_for(parsed, address, all))
        options.headers.push_back(parsed.line);
    }
  }
  return options;
}

}  // namespace

std::filesystem::path temporary_path(std::string_view prefix) {
  std::random_device chance;
  return storage::temporary_folder() / fmt::format("{}{:08x}{:08x}", prefix, chance(), chance());
}

void add_web_options(CLI::App& command, WebOptions& web) {
  command
      .add_option("--header", web.headers,
                  "Of an address: a line of the requests (\"Authorization: Bearer ...\"), or @FILE "
                  "with such lines; its host alone gets it; ~/.netrc counts, too")
      ->type_name("LINE|@FILE")
      ->allow_extra_args(false);
  add_size_option(command, "--limit-rate", "Of an address: fetch no more bytes a second",
                  web.bytes_per_second);
}

void add_hierarchy_options(CLI::App& command, std::string& hierarchy, WebOptions& web,
                           const char* help) {
  command.add_option("HIERARCHY", hierarchy, help)->required();
  add_web_options(command, web);
}

HierarchyPlace::HierarchyPlace(Environment& environment, const std::string& hierarchy,
                               const WebOptions& web)
    : files_(environment.files), path_(hierarchy) {
  if (!storage::is_web_address(hierarchy))
    return;
  remote_ = std::make_unique<storage::RemoteFiles>(
      files_, hierarchy, temporary_path(".meshhier-fetched-"), http_options(files_, web, hierarchy),
      [&cancel = environment.cancel] { cancel.check(); });
  path_ = remote_->root();
}

std::string HierarchyPlace::account() const {
  if (!remote_)
    return "";
  const storage::HttpCounters& counters = remote_->counters();
  return fmt::format("fetched {} in {}\n", execution::rounded_size_text(counters.bytes),
                     counted(counters.requests, "requests"));
}

}  // namespace meshhier::app
