// Who may use whom: the rules of docs/architecture.md, checked on the #include lines of all
// sources.
#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// The rooms of the project, below them what they may include besides their own; tests are free to
/// use anything. A folder in another has rules of its own if it stands here.
const std::map<std::string, std::set<std::string>>& allowed_rooms() {
  static const std::set<std::string> storage = {"storage/format", "storage/io"};
  const auto with_storage = [](std::set<std::string> rooms) {
    rooms.insert(storage.begin(), storage.end());
    return rooms;
  };
  const auto with_base = [](std::map<std::string, std::set<std::string>> all) {
    for (auto& [room, others] : all) {
      if (room != "base" && room != "packaging")
        others.insert("base");
    }
    return all;
  };
  static const std::map<std::string, std::set<std::string>> rules = with_base(
      {{"base", {}},
       {"hierarchy", {}},
       {"storage/io", {"hierarchy"}},
       {"storage/format", {"hierarchy", "storage/io"}},
       {"execution", {"hierarchy", "storage/io"}},
       {"mesh_io", {"geodesy", "hierarchy", "images", "mesh_io/osgb", "storage/io"}},
       {"mesh_io/osgb", {"hierarchy", "images", "storage/io"}},
       {"partition", {"hierarchy", "storage/io"}},
       {"cluster_simplify", {"hierarchy"}},
       {"outline", {"hierarchy"}},
       {"images", {"hierarchy", "storage/io"}},
       {"texture", {"hierarchy", "images"}},
       {"render", {"hierarchy", "images"}},
       {"shading", {"hierarchy"}},
       {"geodesy", {"hierarchy", "storage/io"}},
       {"config", with_storage({"cluster_simplify", "execution", "geodesy", "hierarchy", "mesh_io",
                                "partition"})},
       {"import",
        with_storage({"execution", "geodesy", "hierarchy", "images", "mesh_io", "partition"})},
       {"pipeline/tiles", with_storage({"cluster_simplify", "hierarchy", "images", "partition",
                                        "shading", "texture"})},
       {"pipeline/plan",
        with_storage({"cluster_simplify", "config", "execution", "hierarchy", "images", "import",
                      "mesh_io", "outline", "partition", "pipeline/tiles", "shading", "texture"})},
       {"pipeline/journal", with_storage({"config", "execution", "hierarchy", "images", "import",
                                          "mesh_io", "pipeline/plan", "pipeline/tiles"})},
       {"pipeline",
        with_storage({"cluster_simplify", "config", "execution", "hierarchy", "images", "import",
                      "mesh_io", "outline", "partition", "pipeline/journal", "pipeline/plan",
                      "pipeline/tiles", "render", "shading", "texture"})},
       {"export", with_storage({"config", "execution", "geodesy", "hierarchy", "images", "import",
                                "mesh_io", "partition", "render"})},
       {"drawing", with_storage({"config", "execution", "export", "geodesy", "hierarchy", "images",
                                 "partition", "render"})},
       {"compare", with_storage({"execution", "export", "hierarchy", "mesh_io", "partition"})},
       {"query",
        with_storage({"compare", "execution", "export", "hierarchy", "mesh_io", "partition"})},
       {"verify", with_storage({"compare", "config", "execution", "export", "hierarchy", "images",
                                "import", "mesh_io", "partition"})},
       {"inspection",
        with_storage({"execution", "export", "hierarchy", "images", "import", "render"})},
       {"progressive", with_storage({"execution", "hierarchy", "mesh_io"})},
       {"server", with_storage({"execution", "hierarchy", "mesh_io", "progressive"})},
       {"app",
        {"compare", "config", "drawing", "execution", "export", "hierarchy", "inspection",
         "mesh_io", "pipeline", "pipeline/journal", "pipeline/plan", "progressive", "query",
         "server", "storage/io", "verify"}},
       {"library", with_storage({"config", "execution", "export", "hierarchy", "inspection",
                                 "pipeline", "verify"})},
       {"bench",
        {"cluster_simplify", "compare", "execution", "export", "hierarchy", "images", "import",
         "inspection", "mesh_io", "partition", "render", "storage/format", "storage/io"}},
       {"packaging", {}}});
  return rules;
}

/// The folder with rules of its own in which a path from the root lies; "" if there is none.
std::string room_of(const std::string& path) {
  for (std::size_t end = path.rfind('/'); end != std::string::npos && end > 0;
       end = path.rfind('/', end - 1)) {
    if (allowed_rooms().contains(path.substr(0, end)))
      return path.substr(0, end);
  }
  return "";
}

/// Folders of the root with code that ends in a program.
std::set<std::string> top_folders() {
  std::set<std::string> folders;
  for (const auto& [room, rules] : allowed_rooms())
    folders.insert(room.substr(0, room.find('/')));
  return folders;
}

struct Include {
  std::string name;
  bool quoted = false;
  std::size_t line = 0;
};

struct Source {
  std::string path;  ///< "folder/file.h"
  std::vector<std::string> lines;
  std::vector<Include> includes;

  std::string room() const { return room_of(path); }
  bool is_in(const std::set<std::string>& rooms) const { return rooms.contains(room()); }
};

std::string at(const Source& source, std::size_t line) {
  return source.path + ":" + std::to_string(line);
}

/// `#include "x"` and `#  include <x>`, with any spaces.
bool parse_include(std::string_view line, Include& include) {
  const auto skip = [&](std::size_t from) { return line.find_first_not_of(" \t", from); };
  std::size_t place = skip(0);
  if (place == std::string_view::npos || line[place] != '#')
    return false;
  place = skip(place + 1);
  if (place == std::string_view::npos || !line.substr(place).starts_with("include"))
    return false;
  place = skip(place + std::string_view("include").size());
  if (place == std::string_view::npos || (line[place] != '"' && line[place] != '<'))
    return false;
  include.quoted = line[place] == '"';
  const std::size_t end = line.find(include.quoted ? '"' : '>', place + 1);
  include.name = line.substr(place + 1, end - place - 1);
  return end != std::string_view::npos;
}

Source make_source(std::string path, std::vector<std::string> lines) {
  Source source{std::move(path), std::move(lines), {}};
  for (std::size_t i = 0; i < source.lines.size(); ++i) {
    Include include{{}, false, i + 1};
    if (parse_include(source.lines[i], include))
      source.includes.push_back(include);
  }
  return source;
}

std::vector<Source> read_sources() {
  const fs::path root = MESHHIER_SOURCE_DIR;
  std::vector<Source> sources;
  for (const std::string& folder : top_folders()) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cpp")
        continue;
      std::ifstream stream(entry.path());
      std::vector<std::string> lines;
      for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
      sources.push_back(
          make_source(entry.path().lexically_relative(root).string(), std::move(lines)));
    }
  }
  std::ranges::sort(sources, {}, &Source::path);
  return sources;
}

const std::vector<Source>& sources() {
  static const std::vector<Source> all = read_sources();
  return all;
}

// ---- the rules -----------------------------------------------------------------------------

using Complaints = std::vector<std::string>;
using Rule = std::function<std::string(const Source&, const Include&)>;  ///< "" if all is well

Complaints check(const std::vector<Source>& all, const Rule& rule) {
  Complaints complaints;
  for (const Source& source : all) {
    for (const Include& include : source.includes) {
      const std::string complaint = rule(source, include);
      if (!complaint.empty())
        complaints.push_back(at(source, include.line) + ": " + complaint);
    }
  }
  return complaints;
}

std::string check_folder(const Source& source, const Include& include) {
  if (!include.quoted)
    return "";
  const std::string from = source.room();
  const std::string to = room_of(include.name);
  if (to == from || (!from.empty() && allowed_rooms().at(from).contains(to)))
    return "";
  return (from.empty() ? source.path : from + "/") + " may not include " + include.name;
}

std::string check_exists(const Source&, const Include& include) {
  if (!include.quoted || fs::exists(fs::path(MESHHIER_SOURCE_DIR) / include.name))
    return "";
  return include.name + " is not a path from the project's root";
}

/// Headers of others, by how their names start, and who may include them.
struct ThirdParty {
  std::string prefix;
  std::function<bool(const Source&)> may_use;
};

const std::vector<ThirdParty>& third_parties() {
  const auto in = [](std::set<std::string> rooms) {
    return [rooms](const Source& source) { return source.is_in(rooms); };
  };
  const auto of = [](std::set<std::string> paths) {
    return [paths](const Source& source) { return paths.contains(source.path); };
  };
  static const std::set<std::string> without_text = {
      "base",           "cluster_simplify", "hierarchy", "outline", "partition",
      "pipeline/tiles", "render",           "shading",   "texture"};
  static const std::vector<ThirdParty> rules = {
      {"tbb/",
       [](const Source& s) {
         return s.is_in({"compare", "execution", "pipeline", "pipeline/plan", "progressive"}) ||
                s.path == "partition/parallel_parts.cpp" ||
                s.path == "partition/parallel_sort.cpp" || s.path == "partition/top_tree.cpp";
       }},
      {"oneapi/", in({})},
      {"httplib.h", in({"server"})},
      {"nlohmann/",
       in({"app", "bench", "compare", "config", "execution", "export", "inspection", "mesh_io",
           "mesh_io/osgb", "pipeline", "pipeline/journal", "pipeline/plan", "pipeline/tiles",
           "query", "server", "storage/format", "storage/io", "verify"})},
      {"CLI/", in({"app", "bench"})},
      {"osg", in({"bench", "mesh_io/osgb"})},
      {"CGAL/",
       of({"export/plan_region.cpp", "mesh_io/polygon_cover.cpp", "mesh_io/polygon_turns.cpp"})},
      {"boost/", of({"export/plan_region.cpp"})},
      {"benchmark/", in({"bench"})},
      {"proj.h", of({"geodesy/proj_library.h"})},
      {"curl/", of({"storage/io/http_client.cpp", "storage/io/web_address.cpp"})},
      {"md5.h", of({"storage/io/hash.cpp"})},
      {"xxhash.h", of({"storage/io/hash.cpp"})},
      {"png.h", in({"images"})},
      {"jpeglib.h", in({"images"})},
      {"jerror.h", in({"images"})},
      {"webp/", in({"images"})},
      {"tiff", in({"images"})},
      {"stb/", in({"texture"})},
      {"draco/", in({"mesh_io"})},
      {"zstd.h",
       [](const Source& s) {
         return s.path == "storage/io/zip_content.cpp" || s.is_in({"images"});
       }},
      {"zlib.h", of({"images/tiff_tile.cpp", "mesh_io/gzip_stream.cpp", "mesh_io/inflated_file.cpp",
                     "mesh_io/osgb/stored_png.cpp", "storage/format/gzip.cpp",
                     "storage/io/zip_content.cpp"})},
      {"meshoptimizer.h",
       [](const Source& s) {
         return s.path == "storage/format/meshopt_codec.cpp" || s.is_in({"mesh_io"});
       }},
      {"fmt/", [](const Source& s) { return !s.is_in(without_text); }}};
  return rules;
}

std::string check_third_party(const Source& source, const Include& include) {
  for (const ThirdParty& party : third_parties()) {
    if (!include.quoted && include.name.starts_with(party.prefix) && !party.may_use(source))
      return "<" + include.name + "> is not for this file";
  }
  return "";
}

/// System calls have their one place; what else touches the system is listed here.
std::string check_system(const Source& source, const Include& include) {
  static const std::set<std::string> system = {"unistd.h",  "fcntl.h", "dirent.h",  "poll.h",
                                               "pthread.h", "spawn.h", "termios.h", "signal.h",
                                               "dlfcn.h",   "errno.h", "malloc.h"};
  static const std::map<std::string, std::set<std::string>> exceptions = {
      {"execution/allocator.cpp", {"malloc.h"}},
      {"app/process.cpp", {"csignal", "fcntl.h", "signal.h", "sys/ioctl.h", "unistd.h"}},
      // It is there before any library of the project's.
      {"packaging/portable/launcher.cpp", {"sys/auxv.h", "unistd.h"}},
      // The library's sockets, with limits that it does not have.
      {"server/connection.cpp", {"poll.h", "sys/socket.h", "unistd.h"}},
      {"server/connection_queue.cpp", {"poll.h", "sys/eventfd.h", "unistd.h"}},
      {"server/http_server.cpp", {"sys/socket.h", "unistd.h"}},
      {"storage/io/child_process.cpp",
       {"csignal", "fcntl.h", "poll.h", "sys/prctl.h", "sys/socket.h", "sys/wait.h", "unistd.h"}},
      {"storage/io/code_memory.cpp", {"sys/mman.h", "unistd.h"}},
      {"storage/io/confinement.cpp", {"sys/prctl.h", "sys/resource.h", "sys/time.h", "unistd.h"}},
      {"storage/io/descriptor.h", {"unistd.h"}},
      {"storage/io/file_rights.cpp", {"sys/stat.h", "unistd.h"}},
      {"storage/io/folder.cpp", {"dirent.h", "fcntl.h", "sys/stat.h"}},
      {"storage/io/link_free_paths.cpp", {"dirent.h", "fcntl.h", "sys/stat.h"}},
      {"storage/io/neighbours.cpp", {"fcntl.h", "sys/file.h", "sys/stat.h"}},
      {"storage/io/posix_file.h", {"fcntl.h", "sys/stat.h", "unistd.h"}},
      {"storage/io/own_program.cpp", {"sys/auxv.h"}},
      {"storage/io/process.cpp", {"fcntl.h", "sys/resource.h", "unistd.h"}},
      {"storage/io/usable_memory.cpp", {"sys/resource.h", "unistd.h"}},
      {"storage/io/shared_library.cpp", {"dlfcn.h"}},
      {"storage/io/stream.cpp", {"csignal", "fcntl.h", "poll.h", "sys/stat.h", "unistd.h"}}};
  const bool is_system =
      !include.quoted && (system.contains(include.name) || include.name.starts_with("sys/") ||
                          include.name == "csignal");
  if (!is_system || source.path == "storage/io/file.cpp")
    return "";
  const auto exception = exceptions.find(source.path);
  if (exception != exceptions.end() && exception->second.contains(include.name))
    return "";
  return "<" + include.name + "> belongs into storage/io/file.cpp";
}

/// The names of the standard library have no dot and no slash.
std::string check_only_standard(const Source& source, const Include& include) {
  if (!source.is_in({"base", "hierarchy"}) || include.quoted ||
      include.name.find_first_of("./") == std::string::npos)
    return "";
  return source.room() + "/ may not include <" + include.name + ">";
}

/// Kernels have no threads and touch no files.
std::string check_kernel(const Source& source, const Include& include) {
  static const std::set<std::string> effects = {"thread",     "mutex",   "atomic",
                                                "future",     "fstream", "iostream",
                                                "filesystem", "random",  "chrono"};
  if (!source.is_in(
          {"base", "cluster_simplify", "hierarchy", "outline", "render", "shading", "texture"}) ||
      include.quoted || !effects.contains(include.name))
    return "";
  return "<" + include.name + "> has no place in a kernel";
}

/// The line without its comment and without what stands in quotes, as far as one line tells.
std::string code_of(const std::string& line) {
  std::string code;
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\\') {
      ++i;
    } else if (line[i] == '"') {
      quoted = !quoted;
    } else if (!quoted && line.compare(i, 2, "//") == 0) {
      break;
    } else if (!quoted) {
      code += line[i];
    }
  }
  return code;
}

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Returns whether `word` stands in `code` as a whole word, perhaps with a namespace before it.
bool has_word(const std::string& code, const std::string& word) {
  for (std::size_t i = code.find(word); i != std::string::npos; i = code.find(word, i + 1)) {
    const bool starts = i == 0 || (!is_word(code[i - 1]) && code[i - 1] != '.' &&
                                   (code[i - 1] != '>' || i < 2 || code[i - 2] != '-'));
    const std::size_t end = i + word.size();
    if (starts && (!is_word(word.back()) || end == code.size() || !is_word(code[end])))
      return true;
  }
  return false;
}

/// Libraries throw; only programs print and exit.
Complaints check_quiet(const std::vector<Source>& all) {
  Complaints complaints;
  for (const Source& source : all) {
    if (source.is_in({"app", "bench", "packaging"}) || source.path == "mesh_io/osgb/main.cpp")
      continue;
    for (std::size_t i = 0; i < source.lines.size(); ++i) {
      const std::string code = code_of(source.lines[i]);
      if (source.path == "storage/io/child_process.cpp" && has_word(code, "_exit("))
        continue;  // ends a fork that could not become another program
      for (const char* word : {"cout", "cerr", "clog", "printf(", "fprintf(", "puts(", "fputs(",
                               "perror(", "exit(", "_exit(", "quick_exit(", "abort("}) {
        if (has_word(code, word))
          complaints.push_back(at(source, i + 1) + ": a library does not use " + word);
      }
    }
  }
  return complaints;
}

/// Functions of the C library whose last bits differ between processors and versions, with their
/// variants for float and long double; and those that take a long double, which has 80 or 128 bits.
/// What is left out is exact: sqrt, floor, ldexp and such.
std::set<std::string> inexact_functions() {
  std::set<std::string> names{"generate_canonical", "normal_distribution", "stold", "strtold",
                              "uniform_real_distribution"};
  for (const std::string name :
       {"acos", "acosh", "asin",   "asinh",  "atan", "atan2", "atanh", "cbrt",
        "cos",  "cosh",  "erf",    "erfc",   "exp",  "exp10", "exp2",  "expm1",
        "fma",  "hypot", "lerp",   "lgamma", "log",  "log10", "log1p", "log2",
        "pow",  "sin",   "sincos", "sinh",   "tan",  "tanh",  "tgamma"}) {
    for (const char* suffix : {"", "f", "l"})
      names.insert(name + suffix);
  }
  return names;
}

/// Names of the standard library that no parenthesis follows.
std::vector<std::string> handed_on_in(const std::string& code) {
  static const std::string kBefore = "std::";
  std::vector<std::string> names;
  for (std::size_t at = code.find(kBefore); at != std::string::npos; at = code.find(kBefore, at)) {
    const std::size_t begin = at += kBefore.size();
    while (at < code.size() && is_word(code[at]))
      ++at;
    if (at == code.size() || code[at] != '(')
      names.push_back(code.substr(begin, at - begin));
  }
  return names;
}

/// The names that are called in a line, but for functions of objects and templates; and those of
/// the standard library that are handed on.
std::vector<std::string> called_in(const std::string& line) {
  const std::string code = code_of(line);
  std::vector<std::string> names = handed_on_in(code);
  for (std::size_t end = code.find('('); end != std::string::npos; end = code.find('(', end + 1)) {
    std::size_t begin = end;
    while (begin > 0 && is_word(code[begin - 1]))
      --begin;
    const bool is_member = begin > 0 && (code[begin - 1] == '.' || code[begin - 1] == '>');
    if (!is_member && begin < end)
      names.push_back(code.substr(begin, end - begin));
  }
  return names;
}

/// Results are equal on all processors. What a comparison says to people, in decibels, is none.
Complaints check_exact(const std::vector<Source>& all) {
  static const std::set<std::string> inexact = inexact_functions();
  Complaints complaints;
  for (const Source& source : all) {
    for (std::size_t i = 0;
         i < source.lines.size() && source.path != "bench/texture_comparison.cpp"; ++i) {
      if (has_word(code_of(source.lines[i]), "long double"))
        complaints.push_back(at(source, i + 1) + ": a long double differs between processors");
      for (const std::string& name : called_in(source.lines[i])) {
        if (inexact.contains(name))
          complaints.push_back(at(source, i + 1) + ": " + name + " differs between processors");
      }
    }
  }
  return complaints;
}

/// Each circle of includes once, as the files it runs through.
class Circles {
 public:
  explicit Circles(const std::vector<Source>& all) {
    for (const Source& source : all) {
      for (const Include& include : source.includes) {
        if (include.quoted)
          includes_[source.path].push_back(include);
      }
    }
    for (const Source& source : all)
      visit(source.path);
  }
  const Complaints& complaints() const { return complaints_; }

 private:
  void visit(const std::string& path) {
    if (!finished_.contains(path)) {
      way_.push_back(path);
      for (const Include& include : includes_[path])
        follow(include);
      way_.pop_back();
      finished_.insert(path);
    }
  }

  void follow(const Include& include) {
    const auto found = std::ranges::find(way_, include.name);
    if (found == way_.end())
      return visit(include.name);
    std::string circle = way_.back() + ":" + std::to_string(include.line) + ": a circle: ";
    for (auto file = found; file != way_.end(); ++file)
      circle += *file + " -> ";
    complaints_.push_back(circle + include.name);
  }

  std::map<std::string, std::vector<Include>> includes_;
  std::set<std::string> finished_;
  std::vector<std::string> way_;
  Complaints complaints_;
};

/// The names that stand after `std::` in a line.
std::vector<std::string> standard_names(const std::string& line) {
  const std::string code = code_of(line);
  const std::string_view prefix = "std::";
  std::vector<std::string> names;
  for (std::size_t i = code.find(prefix); i != std::string::npos; i = code.find(prefix, i + 1)) {
    const auto begin = code.begin() + static_cast<std::ptrdiff_t>(i + prefix.size());
    names.emplace_back(begin, std::find_if_not(begin, code.end(), is_word));
  }
  return names;
}

/// Where names of the standard library come from. Every header has std::move and std::size_t.
const std::map<std::string, std::string>& standard_headers() {
  static const std::map<std::string, std::string> headers = [] {
    const std::map<std::string, std::vector<std::string>> names = {
        {"algorithm",
         {"clamp", "find", "find_if", "lower_bound", "max", "max_element", "min", "min_element",
          "nth_element", "remove_if", "reverse", "rotate", "sort", "unique", "upper_bound"}},
        {"array", {"array"}},
        {"atomic", {"atomic"}},
        {"bit", {"bit_cast", "bit_ceil", "bit_width", "countl_zero", "countr_zero", "popcount"}},
        {"charconv", {"from_chars", "to_chars"}},
        {"chrono", {"chrono"}},
        {"cmath",
         {"abs", "ceil", "cos", "fabs", "floor", "isfinite", "isnan", "pow", "round", "sin",
          "sqrt"}},
        {"condition_variable", {"condition_variable"}},
        {"cstddef", {"byte"}},
        {"cstdint", {"int64_t", "uint16_t", "uint32_t", "uint64_t", "uint8_t"}},
        {"cstdlib", {"getenv"}},
        {"cstring", {"memcmp", "memcpy", "memmove", "memset", "strerror"}},
        {"deque", {"deque"}},
        {"exception", {"current_exception", "exception", "exception_ptr", "rethrow_exception"}},
        {"filesystem", {"filesystem"}},
        {"fstream", {"ifstream", "ofstream"}},
        {"functional", {"function", "reference_wrapper"}},
        {"limits", {"numeric_limits"}},
        {"map", {"map"}},
        {"memory", {"make_shared", "make_unique", "shared_ptr", "unique_ptr"}},
        {"mutex", {"lock_guard", "mutex", "scoped_lock", "unique_lock"}},
        {"numeric", {"accumulate", "inner_product", "iota", "partial_sum"}},
        {"optional", {"nullopt", "optional"}},
        {"queue", {"priority_queue", "queue"}},
        {"random", {"mt19937_64", "random_device"}},
        {"set", {"set"}},
        {"span", {"as_bytes", "as_writable_bytes", "span"}},
        {"sstream", {"istringstream", "ostringstream"}},
        {"stdexcept", {"invalid_argument", "logic_error", "runtime_error"}},
        {"string", {"getline", "string", "to_string"}},
        {"string_view", {"string_view"}},
        {"system_error", {"error_code", "system_error"}},
        {"thread", {"this_thread", "thread"}},
        {"tuple", {"tie", "tuple"}},
        {"unordered_map", {"unordered_map"}},
        {"utility", {"exchange", "pair", "swap"}},
        {"variant", {"variant"}},
        {"vector", {"vector"}}};
    std::map<std::string, std::string> all;
    for (const auto& [header, of_header] : names) {
      for (const std::string& name : of_header)
        all[name] = header;
    }
    return all;
  }();
  return headers;
}

/// The files that a file includes, itself or by others, by name.
class Reach {
 public:
  explicit Reach(const std::vector<Source>& all) {
    for (const Source& source : all)
      sources_[source.path] = &source;
  }

  std::set<std::string> of(const std::string& path) const {
    std::set<std::string> reached = {path};
    for (std::vector<std::string> open = {path}; !open.empty();) {
      const auto source = sources_.find(open.back());
      open.pop_back();
      if (source == sources_.end())
        continue;
      for (const Include& include : source->second->includes) {
        if (reached.insert(include.name).second)
          open.push_back(include.name);
      }
    }
    return reached;
  }

 private:
  std::map<std::string, const Source*> sources_;
};

/// A file included where others have been, which is what its name says.
bool stands_alone(const Source& source) {
  return !source.path.ends_with("_impl.h");
}

/// Where all files of a folder are compiled as one, no compiler misses an include.
Complaints check_standard_names(const std::vector<Source>& all) {
  const Reach reach(all);
  Complaints complaints;
  for (const Source& source : all) {
    const std::set<std::string> reached = reach.of(source.path);
    for (std::size_t i = 0; i < source.lines.size() && stands_alone(source); ++i) {
      for (const std::string& name : standard_names(source.lines[i])) {
        const auto header = standard_headers().find(name);
        if (header != standard_headers().end() && !reached.contains(header->second))
          complaints.push_back(at(source, i + 1) + ": std::" + name + " without <" +
                               header->second + ">");
      }
    }
  }
  return complaints;
}

/// The type that a line declares at its beginning, so not within another type; "" if none.
std::string declared_type(const std::string& line) {
  for (const std::string word : {"class ", "struct ", "enum class ", "using "}) {
    if (line.starts_with(word)) {
      const auto begin = line.begin() + static_cast<std::ptrdiff_t>(word.size());
      return {begin, std::find_if_not(begin, line.end(), is_word)};
    }
  }
  return "";
}

/// Returns the words of a line, but for those of OpenSceneGraph, which has types of the same names.
std::vector<std::string> words_of(const std::string& line) {
  static const std::regex foreign(R"(\bosg(DB)?::\w+|#\s*include\s*<.*)");
  const std::string code = std::regex_replace(code_of(line), foreign, "");
  std::vector<std::string> words;
  for (auto at = code.begin(); at != code.end();) {
    const auto begin = std::find_if(at, code.end(), is_word);
    at = std::find_if_not(begin, code.end(), is_word);
    if (begin != at)
      words.emplace_back(begin, at);
  }
  return words;
}

/// Returns the names that a file declares itself: types, also within others, and parameters of
/// templates.
std::set<std::string> types_declared_in(const Source& source) {
  std::set<std::string> types;
  for (const std::string& line : source.lines) {
    bool declares = false;
    for (const std::string& word : words_of(line)) {
      if (declares)
        types.insert(word);
      declares = declares || word == "class" || word == "struct" || word == "using" ||
                 word == "enum" || word == "typename";
    }
  }
  return types;
}

/// The same for the project's types, as far as their names tell: those that one header declares,
/// and no other file.
Complaints check_own_types(const std::vector<Source>& all) {
  std::map<std::string, std::set<std::string>> declared;
  for (const Source& source : all) {
    for (const std::string& line : source.lines)
      declared[declared_type(line)].insert(source.path);
  }
  const Reach reach(all);
  Complaints complaints;
  for (const Source& source : all) {
    const std::set<std::string> reached = reach.of(source.path);
    const std::set<std::string> own = types_declared_in(source);
    for (std::size_t i = 0; i < source.lines.size() && stands_alone(source); ++i) {
      for (const std::string& word : words_of(source.lines[i])) {
        const auto files = declared.find(word);
        if (files == declared.end() || files->second.size() != 1 || own.contains(word))
          continue;
        const std::string& header = *files->second.begin();
        if (header.ends_with(".h") && !reached.contains(header) &&
            check_folder(source, {header, true, i + 1}).empty())
          complaints.push_back(at(source, i + 1) + ": " + word + " without \"" + header + "\"");
      }
    }
  }
  return complaints;
}

// ---- the project keeps them ----------------------------------------------------------------

TEST(ArchitectureTest, TheSourcesAreThere) {
  EXPECT_GT(sources().size(), 50U) << "in " << MESHHIER_SOURCE_DIR;
  for (const auto& [room, rules] : allowed_rooms()) {
    EXPECT_TRUE(std::ranges::any_of(sources(), [&](const Source& s) { return s.room() == room; }))
        << room;
  }
}

TEST(ArchitectureTest, EveryFolderWithSourcesHasItsRule) {
  const std::set<std::string> known = top_folders();
  for (const auto& entry : fs::directory_iterator(MESHHIER_SOURCE_DIR)) {
    const std::string name = entry.path().filename().string();
    // Those of examples/ are programs of their own, which are built as a stranger would.
    if (!entry.is_directory() || name == "tests" || name == "examples" || name == "build" ||
        name.starts_with('.'))
      continue;
    const bool has_sources = std::ranges::any_of(
        fs::recursive_directory_iterator(entry.path()), [](const fs::directory_entry& file) {
          const bool is_source =
              file.path().extension() == ".cpp" || file.path().extension() == ".h";
          return is_source && file.path().string().find("/node_modules/") == std::string::npos;
        });
    EXPECT_TRUE(!has_sources || known.contains(name)) << name << "/ has no rule in this test";
  }
  for (const Source& source : sources())
    EXPECT_NE(source.room(), "") << source.path << " lies in no room";
}

TEST(ArchitectureTest, FoldersUseOnlyWhatTheyMay) {
  EXPECT_THAT(check(sources(), check_folder), IsEmpty());
}

TEST(ArchitectureTest, IncludesAreFromTheRoot) {
  EXPECT_THAT(check(sources(), check_exists), IsEmpty());
}

TEST(ArchitectureTest, NoFileIncludesItselfInACircle) {
  EXPECT_THAT(Circles(sources()).complaints(), IsEmpty());
}

TEST(ArchitectureTest, TheVocabularyNeedsTheStandardLibraryOnly) {
  EXPECT_THAT(check(sources(), check_only_standard), IsEmpty());
}

TEST(ArchitectureTest, KernelsHaveNoSideEffects) {
  EXPECT_THAT(check(sources(), check_kernel), IsEmpty());
}

TEST(ArchitectureTest, LibrariesOfOthersHaveTheirPlaces) {
  EXPECT_THAT(check(sources(), check_third_party), IsEmpty());
}

TEST(ArchitectureTest, SystemCallsHaveOnePlace) {
  EXPECT_THAT(check(sources(), check_system), IsEmpty());
}

TEST(ArchitectureTest, LibrariesNeitherPrintNorExit) {
  EXPECT_THAT(check_quiet(sources()), IsEmpty());
}

TEST(ArchitectureTest, NoResultDependsOnTheLibrarysTrigonometry) {
  EXPECT_THAT(check_exact(sources()), IsEmpty());
}

TEST(ArchitectureTest, FilesIncludeWhatTheyUse) {
  EXPECT_THAT(check_standard_names(sources()), IsEmpty());
  EXPECT_THAT(check_own_types(sources()), IsEmpty());
}

TEST(ArchitectureTest, EverySourceIsOfALibraryOrProgram) {
  for (const Source& source : sources()) {
    if (!source.path.ends_with(".cpp"))
      continue;
    fs::path list = fs::path(MESHHIER_SOURCE_DIR) / fs::path(source.path).parent_path();
    while (!fs::exists(list / "CMakeLists.txt"))
      list = list.parent_path();
    std::ifstream stream(list / "CMakeLists.txt");
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const fs::path file = fs::path(MESHHIER_SOURCE_DIR) / source.path;
    EXPECT_THAT(text, HasSubstr(file.lexically_relative(list).string()))
        << source.path << " is built by nobody";
  }
}

// ---- the rules find what they are for ------------------------------------------------------

Complaints complaints_about(const std::string& path, const std::string& line, const Rule& rule) {
  return check({make_source(path, {"#pragma once", line})}, rule);
}

TEST(ArchitectureRuleTest, FolderRulesNameFileAndLine) {
  EXPECT_THAT(complaints_about("outline/x.h", "#include \"partition/chunk.h\"", check_folder),
              testing::ElementsAre("outline/x.h:2: outline/ may not include partition/chunk.h"));
  EXPECT_THAT(complaints_about("hierarchy/x.h", "#include \"storage/io/file.h\"", check_folder),
              SizeIs(1));
  EXPECT_THAT(complaints_about("storage/io/x.h", "#include \"pipeline/build.h\"", check_folder),
              SizeIs(1));
  EXPECT_THAT(
      complaints_about("partition/x.h", "#include \"storage/format/layout.h\"", check_folder),
      SizeIs(1));
  EXPECT_THAT(complaints_about("pipeline/x.h", "#include \"app/process.h\"", check_folder),
              SizeIs(1));
  EXPECT_THAT(
      complaints_about("storage/io/x.h", "#include \"storage/format/layout.h\"", check_folder),
      SizeIs(1));
  EXPECT_THAT(complaints_about("pipeline/plan/x.h", "#include \"pipeline/build.h\"", check_folder),
              SizeIs(1));
  EXPECT_THAT(complaints_about("storage/x.h", "#include \"storage/io/file.h\"", check_folder),
              testing::ElementsAre("storage/x.h:2: storage/x.h may not include storage/io/file.h"));
  EXPECT_THAT(complaints_about("partition/x.h", " # include \"storage/io/spool.h\"", check_folder),
              IsEmpty());
}

TEST(ArchitectureRuleTest, OtherRulesFindTheirOffenders) {
  EXPECT_THAT(complaints_about("storage/io/x.cpp", "#include <tbb/task.h>", check_third_party),
              SizeIs(1));
  EXPECT_THAT(
      complaints_about("partition/x.cpp", "#include <nlohmann/json.hpp>", check_third_party),
      SizeIs(1));
  EXPECT_THAT(complaints_about("pipeline/x.cpp", "#include <CLI/CLI.hpp>", check_third_party),
              SizeIs(1));
  EXPECT_THAT(complaints_about("app/x.cpp", "#include <httplib.h>", check_third_party), SizeIs(1));
  EXPECT_THAT(complaints_about("mesh_io/x.cpp", "#include <sys/mman.h>", check_system), SizeIs(1));
  EXPECT_THAT(complaints_about("server/site.cpp", "#include <sys/socket.h>", check_system),
              SizeIs(1));
  EXPECT_THAT(complaints_about("geodesy/x.cpp", "#include <dlfcn.h>", check_system), SizeIs(1));
  EXPECT_THAT(complaints_about("pipeline/build.cpp", "#include <malloc.h>", check_system),
              SizeIs(1));
  EXPECT_THAT(complaints_about("hierarchy/x.h", "#include <fmt/format.h>", check_only_standard),
              SizeIs(1));
  EXPECT_THAT(complaints_about("outline/x.cpp", "#include <thread>", check_kernel), SizeIs(1));
  EXPECT_THAT(complaints_about("storage/io/x.cpp", "#include \"file.h\"", check_exists), SizeIs(1));
}

TEST(ArchitectureRuleTest, PrintsAreFoundButNotInWordsOrStrings) {
  const auto found = [](const std::string& line) {
    return check_quiet({make_source("storage/io/x.cpp", {line})}).size();
  };
  EXPECT_EQ(found("  std::cout << 1;"), 1U);
  EXPECT_EQ(found("  if (bad) exit(1);"), 1U);
  EXPECT_EQ(found("  printf(\"x\");"), 1U);
  EXPECT_EQ(found("  std::abort();"), 1U);
  EXPECT_EQ(found("  const int account = on_exit(2);  // exit(1) is for programs"), 0U);
  EXPECT_EQ(found("  fail(\"std::cout is full\");"), 0U);
  EXPECT_EQ(found("  std::snprintf(text, 3, format);"), 0U);
}

TEST(ArchitectureRuleTest, InexactFunctionsAreFoundButNotInWordsOrMembers) {
  const auto found = [](const std::string& room, const std::string& line) {
    return check_exact({make_source(room + "/x.cpp", {line})}).size();
  };
  EXPECT_EQ(found("outline", "  y = std::sin(x) + cosf(x);"), 2U);
  EXPECT_EQ(found("pipeline", "  return pow(x, -3);"), 1U);
  EXPECT_EQ(found("bench", "  std::ranges::transform(all, all.begin(), std::cosf);"), 1U);
  EXPECT_EQ(found("render", "  std::uniform_real_distribution<double> part(0, 1);"), 1U);
  EXPECT_EQ(check_exact({make_source("bench/texture_comparison.cpp", {"x = log10(y);"})}).size(),
            0U);
  EXPECT_EQ(found("outline", "  y = turn.sin(x) + using(x) + std::sqrt(x);  // sin(x)"), 0U);
  EXPECT_EQ(found("server", "  f(&std::sinister, std::expected<int, Error>(1));"), 0U);
}

TEST(ArchitectureRuleTest, MissingIncludesAreFound) {
  const Source header = make_source(
      "hierarchy/shape.h", {"#include <vector>", "struct Shape {", "  std::vector<int> n;", "};"});
  const auto complaints = [&](const std::vector<std::string>& lines) {
    const std::vector<Source> all = {header, make_source("outline/x.cpp", lines)};
    Complaints found = check_standard_names(all);
    std::ranges::copy(check_own_types(all), std::back_inserter(found));
    return found;
  };
  EXPECT_THAT(complaints({"std::vector<Shape> all;  // std::map"}),
              testing::ElementsAre("outline/x.cpp:1: std::vector without <vector>",
                                   "outline/x.cpp:1: Shape without \"hierarchy/shape.h\""));
  EXPECT_THAT(complaints({"#include \"hierarchy/shape.h\"", "std::vector<Shape> all;"}), IsEmpty());
  EXPECT_THAT(complaints({"struct Shape;", "void draw(const Shape&);"}), IsEmpty());
}

TEST(ArchitectureRuleTest, CirclesAreFound) {
  const std::vector<Source> ring = {make_source("a/a.h", {"#include \"a/b.h\""}),
                                    make_source("a/b.h", {"", "#include \"a/c.h\""}),
                                    make_source("a/c.h", {"#include \"a/a.h\""})};
  EXPECT_THAT(Circles(ring).complaints(),
              testing::ElementsAre("a/c.h:1: a circle: a/a.h -> a/b.h -> a/c.h -> a/a.h"));
  const std::vector<Source> diamond = {
      make_source("a/a.h", {"#include \"a/b.h\"", "#include \"a/c.h\""}),
      make_source("a/b.h", {"#include \"a/d.h\""}), make_source("a/c.h", {"#include \"a/d.h\""})};
  EXPECT_THAT(Circles(diamond).complaints(), IsEmpty());
}

}  // namespace
}  // namespace meshhier
