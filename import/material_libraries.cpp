#include "import/material_libraries.h"

#include "base/small_letters.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTileMark = "<UDIM>";
/// A library of 100,000 materials has less than half of it.
constexpr std::uint64_t kMostLibraryBytes = std::uint64_t{1} << 26;

/// Returns a name without the text behind " #", which may be a comment or belong to the name.
std::string without_comment(const std::string& name) {
  std::string cut = name.substr(0, name.find(" #"));
  cut.resize(cut.find_last_not_of(' ') + 1);
  return cut;
}

/// A name that spaces may be in has at most so many.
constexpr std::size_t kMostSpaces = 15;

struct Word {
  std::size_t begin, end;  ///< range in its text
};

std::vector<Word> words_of(std::string_view text) {
  std::vector<Word> words;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    if (end > at)
      words.push_back({at, end});
    at = end + 1;
  }
  return words;
}

class LibraryReader {
 public:
  LibraryReader(const MaterialNames& names, mesh_io::NamedFiles& files, CompanionFiles& companions,
                const execution::CancelToken& cancel)
      : names_(names),
        folder_(names.obj().parent_path()),
        files_(files),
        companions_(companions),
        cancel_(cancel) {
    read_.materials.resize(names.all().size());
    ranks_.resize(names.all().size(), UINT64_MAX);
    for (std::size_t i = 0; i < names.all().size(); ++i) {
      const auto& name = names.all()[i].name;
      if (!name)
        continue;
      wanted_[*name].push_back(i);
      loose_.emplace(small_letters(*name), Loose{});
    }
    add_names_without_comments();
  }

  Libraries read(const std::vector<std::string>& statements) {
    for (statement_ = 0; statement_ < statements.size(); ++statement_)
      read_statement(statements[statement_]);
    use_other_cases();
    if (has_undefined())
      read_namesake();
    if (!names_.are_used() && read_.materials.size() == 1 && defined_.size() == 1)
      read_.materials[0] = *std::move(only_);
    read_.defined = defined_.size();
    return std::move(read_);
  }

 private:
  /// The materials that a name in small letters may mean.
  struct Loose {
    std::optional<LibraryMaterial> material;
    bool is_clear = true;  ///< all are of one name
  };

  bool is_undefined(std::size_t number) const {
    return names_.all()[number].name && !read_.materials[number].is_defined;
  }

  bool has_undefined() const {
    for (std::size_t i = 0; i < read_.materials.size(); ++i) {
      if (is_undefined(i))
        return true;
    }
    return false;
  }

  void use_other_cases() {
    for (std::size_t i = 0; i < read_.materials.size(); ++i) {
      if (!is_undefined(i))
        continue;
      const Loose& loose = loose_.at(small_letters(*names_.all()[i].name));
      if (loose.material && loose.is_clear)
        read_.materials[i] = *loose.material;
    }
  }

  /// Reads NAME.mtl beside NAME.obj.
  void read_namesake() {
    const std::string name = names_.obj().stem().string() + ".mtl";
    if (const auto file = files_.find(folder_, name))
      read_file(*file);
    else
      companions_.await(mesh_io::sought_places(folder_, name));
    use_other_cases();
  }

  /// Adds names without comments, unless they are names of their own.
  void add_names_without_comments() {
    std::map<std::string, std::vector<std::size_t>> more;
    for (const auto& [name, numbers] : wanted_) {
      const std::string cut = without_comment(name);
      if (!wanted_.contains(cut))
        more[cut].insert(more[cut].end(), numbers.begin(), numbers.end());
    }
    wanted_.merge(more);
  }

  /// Reads a statement: one name with spaces, or several names, which may have some too.
  void read_statement(const std::string& statement) {
    if (const auto whole = files_.find(folder_, statement))
      return read_file(*whole);
    const std::string text = without_comment(statement);
    const std::vector<Word> words = words_of(text);
    for (std::size_t first = 0; first < words.size();) {
      const std::size_t next = read_name(text, words, first);
      if (next == first)
        miss(statement, text.substr(words[first].begin, words[first].end - words[first].begin));
      first = std::max(next, first + 1);
    }
  }

  /// Reads the file whose name begins with a word, and has the fewest. Returns what comes behind
  /// it, `first` if there is none.
  std::size_t read_name(const std::string& text, const std::vector<Word>& words,
                        std::size_t first) {
    const std::size_t most = std::min(words.size(), first + 1 + kMostSpaces);
    for (std::size_t next = first + 1; next <= most; ++next) {
      const std::size_t begin = words[first].begin;
      if (const auto file = files_.find(folder_, text.substr(begin, words[next - 1].end - begin))) {
        read_file(*file);
        return next;
      }
    }
    return first;
  }

  void miss(const std::string& statement, const std::string& word) {
    if (++read_.missing == 1)
      read_.first_missing = statement;
    companions_.await(mesh_io::sought_places(folder_, statement));
    companions_.await(mesh_io::sought_places(folder_, word));
  }

  void read_file(const fs::path& path) {
    if (!done_.insert(path).second)
      return;
    companions_.add({path, InputPart::library, files_.files().identity(path)});
    const auto file = files_.files().open(path);
    if (file->size() > kMostLibraryBytes) {
      mesh_io::fail_file(path, fmt::format("expected a material library of at most {} bytes, found "
                                           "{}",
                                           kMostLibraryBytes, file->size()));
    }
    mesh_io::MtlColours colours;
    read_materials(*file, path, [&](const auto& material) { colours.add(material); });
    read_.of_bytes += colours.are_bytes() ? 1 : 0;
    read_materials(*file, path, [&](const auto& material) { define(material, colours, path); });
  }

  template <class Visit>
  void read_materials(const storage::File& file, const fs::path& path, const Visit& visit) const {
    const auto stream =
        mesh_io::open_stream({file, file.size()}, [this](std::uint64_t) { cancel_.check(); });
    mesh_io::read_mtl(*stream, path, visit);
  }

  /// Returns a rank that is least for the definition that a use means.
  std::uint64_t rank_of(const MaterialNames::Use& use) const {
    const std::uint64_t libraries = names_.libraries().size();
    const bool is_before =
        use.last_library != MaterialNames::kNoLibrary && statement_ <= use.last_library;
    return is_before ? use.last_library - statement_ : libraries + statement_;
  }

  void define(const mesh_io::MtlMaterial& read, const mesh_io::MtlColours& colours,
              const fs::path& library) {
    const bool is_first = defined_.size() < 2 && defined_.insert(read.name).second;
    if (is_first && defined_.size() == 1)
      only_ = made_of(read, colours, library);
    define_loosely(read, colours, library);
    const auto wanted = wanted_.find(read.name);
    if (wanted == wanted_.end())
      return;
    for (const std::size_t number : wanted->second) {
      const std::uint64_t rank = rank_of(names_.all()[number]);
      if (rank >= ranks_[number])
        continue;
      ranks_[number] = rank;
      read_.materials[number] = made_of(read, colours, library);
    }
  }

  void define_loosely(const mesh_io::MtlMaterial& read, const mesh_io::MtlColours& colours,
                      const fs::path& library) {
    const auto found = loose_.find(small_letters(read.name));
    if (found == loose_.end())
      return;
    Loose& loose = found->second;
    if (loose.material)
      loose.is_clear = loose.is_clear && loose.material->material.name == read.name;
    else
      loose.material = made_of(read, colours, library);
  }

  static LibraryMaterial made_of(const mesh_io::MtlMaterial& read,
                                 const mesh_io::MtlColours& colours, const fs::path& library) {
    LibraryMaterial made;
    made.is_defined = true;
    made.defined_in = library;
    made.map = read.picture;
    const auto [red, green, blue] = colours.shown(read);
    made.material.name = read.name;
    made.material.colour = {red, green, blue, read.opacity};
    if (read.picture && read.picture->clamp)
      made.material.wrap_u = made.material.wrap_v = Wrap::clamp;
    const bool is_own_alpha = read.alpha && read.picture && read.alpha->file == read.picture->file;
    made.has_other_alpha = read.alpha && !is_own_alpha;
    made.material.is_alpha_unsaid = read.picture && !read.alpha && read.opacity == 1;
    made.material.alpha = read.opacity < 1 ? AlphaMode::blend
                          : is_own_alpha   ? AlphaMode::mask
                                           : AlphaMode::opaque;
    return made;
  }

  const MaterialNames& names_;
  fs::path folder_;
  mesh_io::NamedFiles& files_;
  CompanionFiles& companions_;
  const execution::CancelToken& cancel_;
  std::map<std::string, std::vector<std::size_t>> wanted_;  ///< numbers of each name
  std::map<std::string, Loose> loose_;                      ///< wanted names, in small letters
  std::set<std::string> defined_;                           ///< names, two at most
  std::optional<LibraryMaterial> only_;
  std::uint64_t statement_ = 0;       ///< whose files are read
  std::vector<std::uint64_t> ranks_;  ///< ranks of the materials that uses mean so far
  std::set<fs::path> done_;
  Libraries read_;
};

}  // namespace

void MaterialNames::limit(std::size_t count, std::size_t more_bytes) {
  bytes_ += more_bytes;
  if (count == kMost || bytes_ > kMostBytes) {
    mesh_io::fail_file(obj_, fmt::format("expected at most {} materials and as many libraries, "
                                         "with names of {} bytes together, found more",
                                         kMost, kMostBytes));
  }
}

void MaterialNames::add_libraries(const std::string& statement) {
  const auto next = static_cast<std::uint32_t>(libraries_.size());
  const auto [known, is_new] = known_libraries_.emplace(statement, next);
  library_ = known->second;
  if (!is_new)
    return;
  limit(libraries_.size(), statement.size());
  libraries_.push_back(statement);
}

std::uint32_t MaterialNames::use(bool has_texcoords) {
  if (!number_) {
    const auto next = static_cast<std::uint32_t>(uses_.size());
    const auto [known, is_new] = numbers_.emplace(current_, next);
    if (is_new) {
      limit(uses_.size(), current_.first ? current_.first->size() : 0);
      uses_.push_back({current_.first, current_.second});
    }
    number_ = known->second;
  }
  uses_[*number_].has_texcoords |= has_texcoords;
  return *number_;
}

bool MaterialNames::are_used() const {
  return std::ranges::any_of(uses_, [](const Use& use) { return use.name.has_value(); });
}

bool LibraryMaterial::is_tiled() const {
  return map && map->file.find(kTileMark) != std::string::npos;
}

std::string LibraryMaterial::file_of(std::uint32_t tile) const {
  std::string name = map->file;
  if (const std::size_t at = name.find(kTileMark); at != std::string::npos)
    name.replace(at, kTileMark.size(), std::to_string(tile));
  return name;
}

Libraries read_libraries(const MaterialNames& names, mesh_io::NamedFiles& files,
                         CompanionFiles& companions, const execution::CancelToken& cancel) {
  return LibraryReader(names, files, companions, cancel).read(names.libraries());
}

}  // namespace meshhier::importing
