#include "mesh_io/mtl_reader.h"

#include "base/small_letters.h"
#include "mesh_io/input_error.h"
#include "mesh_io/number_text.h"
#include "mesh_io/utf16_stream.h"
#include "mesh_io/word_stream.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace meshhier::mesh_io {
namespace {

constexpr std::string_view kWordBlanks = " \t\v\f";

/// A texture option and how many words follow it: -s 1 1, or as many of three as are numbers.
struct MapOption {
  std::string_view name;
  std::size_t words;
};
constexpr std::size_t kUpToThreeNumbers = 0;
constexpr MapOption kMapOptions[] = {{"-blendu", 1},
                                     {"-blendv", 1},
                                     {"-bm", 1},
                                     {"-boost", 1},
                                     {"-cc", 1},
                                     {"-clamp", 1},
                                     {"-imfchan", 1},
                                     {"-mm", 2},
                                     {"-texres", 1},
                                     {"-type", 1},
                                     {"-o", kUpToThreeNumbers},
                                     {"-s", kUpToThreeNumbers},
                                     {"-t", kUpToThreeNumbers}};

/// The first word of `text`, which begins with no blank.
std::string_view head_of(std::string_view text) {
  return text.substr(0, text.find_first_of(kWordBlanks));
}

void drop_head(std::string_view& text) {
  text.remove_prefix(head_of(text).size());
  text.remove_prefix(std::min(text.find_first_not_of(kWordBlanks), text.size()));
}

std::optional<double> finite_number(std::string_view word) {
  const auto number = parse_decimal(word);
  return number && std::isfinite(number->value) ? std::optional(number->value) : std::nullopt;
}

std::string without_quotes(std::string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return std::string(quoted ? text.substr(1, text.size() - 2) : text);
}

class MtlReader {
 public:
  MtlReader(InputStream& stream, const std::filesystem::path& path,
            const std::function<void(const MtlMaterial&)>& visit)
      : words_(stream, path, {.joins_lines = true}), visit_(visit) {}

  void read() {
    while (words_.to_row())
      read_statement(small_letters(words_.take_word()));
    finish();
  }

 private:
  void read_statement(const std::string& word) {
    if (word == "newmtl")
      return begin(words_.take_rest());
    if (!has_begun_)
      return words_.skip_line();
    if (word == "kd")
      return read_colour();
    if (word == "d")
      return read_opacity();
    if (word == "tr")
      return read_transparency();
    if (word == "map_kd")
      return read_map(material_.picture);
    if (word == "map_ke")
      return read_map(light_);
    if (word == "map_ka")
      return read_map(ambient_);
    if (word == "map_d")
      return read_map(material_.alpha);
    words_.skip_line();
  }

  void begin(std::string name) {
    finish();
    material_ = {};
    light_.reset();
    ambient_.reset();
    material_.name = std::move(name);
    has_begun_ = true;
    has_opacity_ = false;
  }

  /// Programs disagree whether `Tr 1` is clear or solid; nobody exports what is not to be seen.
  void finish() {
    if (material_.opacity == 0)
      material_.opacity = 1;
    for (const std::optional<MtlMap>& other : {light_, ambient_}) {
      if (!material_.picture)
        material_.picture = other;
    }
    if (has_begun_)
      visit_(material_);
  }

  /// Spectra and CIE colours, which nobody writes, are passed over.
  void read_colour() {
    const std::string text = words_.take_rest();
    std::string_view rest = text;
    if (rest.starts_with("spectral") || rest.starts_with("xyz"))
      return;
    std::array<float, 3>& colour = material_.colour.emplace();
    for (std::size_t i = 0; i < colour.size(); ++i, drop_head(rest)) {
      const bool is_missing = rest.empty() || rest.front() == '#';
      if (is_missing && i == 1) {
        colour[1] = colour[2] = colour[0];
        return;
      }
      colour[i] = static_cast<float>(number_of(head_of(rest), "a colour"));
    }
  }

  float share_of(std::string_view word, std::string_view what) const {
    return static_cast<float>(std::clamp(number_of(word, what), 0.0, 1.0));
  }

  double number_of(std::string_view word, std::string_view what) const {
    const auto number = finite_number(word);
    if (!number)
      words_.fail("expected a finite number for " + std::string(what) + ", found " +
                  number_in_quotes(word));
    return *number;
  }

  void read_opacity() {
    const std::string text = words_.take_rest();
    std::string_view rest = text;
    if (head_of(rest) == "-halo")
      drop_head(rest);
    material_.opacity = share_of(head_of(rest), "an opacity");
    has_opacity_ = true;
  }

  void read_transparency() {
    const std::string rest = words_.take_rest();
    const float transparency = share_of(head_of(rest), "a transparency");
    if (!has_opacity_)
      material_.opacity = 1 - transparency;
  }

  void read_map(std::optional<MtlMap>& map) {
    const std::string text = words_.take_rest();
    std::string_view rest = text;
    MtlMap read;
    while (read_option(rest, read)) {
    }
    read.file = without_quotes(rest);
    if (!read.file.empty() && !map)
      map = std::move(read);
  }

  /// Returns false if there is none; a word that looks like one and is not begins the file's name.
  bool read_option(std::string_view& rest, MtlMap& map) {
    const std::string name = small_letters(head_of(rest));
    const auto option = std::ranges::find(kMapOptions, std::string_view(name), &MapOption::name);
    if (option == std::end(kMapOptions))
      return false;
    drop_head(rest);
    if (option->words == kUpToThreeNumbers) {
      read_numbers(rest, name, name == "-o" ? &map.offset : name == "-s" ? &map.scale : nullptr);
      return true;
    }
    if (name == "-clamp")
      map.clamp = small_letters(head_of(rest)) == "on";
    for (std::size_t i = 0; i < option->words; ++i)
      drop_head(rest);
    return true;
  }

  /// Reads one to three numbers, and keeps two. The last word of the line is the file's name, even
  /// if it is a number.
  void read_numbers(std::string_view& rest, const std::string& option,
                    std::array<double, 2>* numbers) {
    std::size_t count = 0;
    for (; count < 3 && head_of(rest) != rest; ++count) {
      const auto number = finite_number(head_of(rest));
      if (!number)
        break;
      if (numbers != nullptr && count < numbers->size())
        (*numbers)[count] = *number;
      drop_head(rest);
    }
    if (count == 0)
      words_.fail("expected numbers behind " + option + " and then the name of a picture, found " +
                  in_quotes(rest));
  }

  WordStream words_;
  const std::function<void(const MtlMaterial&)>& visit_;
  MtlMaterial material_;
  std::optional<MtlMap> light_, ambient_;  ///< map_Ke, map_Ka
  bool has_begun_ = false;                 ///< true from the first newmtl on
  bool has_opacity_ = false;
};

}  // namespace

void MtlColours::add(const MtlMaterial& material) {
  if (!material.colour)
    return;
  for (const float number : *material.colour) {
    all_whole_ = all_whole_ && number >= 0 && number <= 255 && number == std::floor(number);
    most_ = std::max(most_, number);
  }
}

std::array<float, 3> MtlColours::shown(const MtlMaterial& material) const {
  std::array<float, 3> colour = material.colour.value_or(std::array<float, 3>{1, 1, 1});
  const bool are_divided = material.colour && are_bytes();
  for (float& number : colour)
    number = std::clamp(are_divided ? number / 255 : number, 0.0F, 1.0F);
  return colour;
}

void read_mtl(InputStream& stream, const std::filesystem::path& path,
              const std::function<void(const MtlMaterial&)>& visit) {
  Utf16Stream text(stream, path);
  MtlReader(text, path, visit).read();
}

}  // namespace meshhier::mesh_io
