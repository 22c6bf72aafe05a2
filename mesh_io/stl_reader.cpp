#include "mesh_io/stl_reader.h"

#include "mesh_io/coordinate_range.h"
#include "mesh_io/input_error.h"
#include "mesh_io/line_blocks.h"
#include "mesh_io/object_choice.h"
#include "mesh_io/ply_values.h"
#include "mesh_io/stl_block.h"
#include "mesh_io/text_stream.h"
#include "mesh_io/word_stream.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

/// Facets handed out at once: 290 KiB.
constexpr std::size_t kBlockFacets = 4096;

constexpr bool kSwap = std::endian::native == std::endian::big;

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

class BinaryStl {
 public:
  BinaryStl(InputStream& stream, const std::filesystem::path& path, const SoupVisitor& visit,
            const StlAttributeVisitor& visit_attributes)
      : stream_(stream),
        path_(path),
        visit_(visit),
        visit_attributes_(visit_attributes),
        bytes_(kBlockFacets * kStlFacetBytes) {}

  StlCounts read() {
    if (stream_.read(std::span(bytes_).first(kStlHeaderBytes)) < kStlHeaderBytes)
      fail_file(path_, "expected the header of a binary STL, found the end of the data");
    counts_.facets = load<std::uint32_t, kSwap>(bytes_.data() + kStlHeaderBytes - 4);
    counts_.header_colour = stl_header_colour(std::span(bytes_).first(kStlHeaderBytes - 4));
    if (counts_.facets == 0)
      return read_all();
    while (done_ < counts_.facets)
      read_block();
    while (const std::size_t more = stream_.read(bytes_))
      counts_.bytes_behind += more;
    return counts_;
  }

 private:
  StlCounts read_all() {
    for (bool is_full = true; is_full;) {
      const std::size_t size = stream_.read(bytes_);
      is_full = size == bytes_.size();
      take_facets(size);
      counts_.bytes_behind = size % kStlFacetBytes;
    }
    counts_.facets = done_;
    return counts_;
  }

  std::uint64_t offset() const { return kStlHeaderBytes + done_ * kStlFacetBytes; }

  void read_block() {
    const std::uint64_t first = done_;
    const std::size_t wanted = std::min<std::uint64_t>(kBlockFacets, counts_.facets - done_);
    const std::size_t size = stream_.read(std::span(bytes_).first(wanted * kStlFacetBytes));
    take_facets(size);
    if (done_ - first < wanted) {
      fail_at_byte(path_, offset(),
                   fmt::format("expected facet {} of {}, found the end of the data (truncated)",
                               done_, counts_.facets));
    }
  }

  /// Takes the facets in the first bytes of the buffer.
  void take_facets(std::size_t bytes) {
    block_.clear();
    attributes_.clear();
    for (std::size_t i = 0; i < bytes / kStlFacetBytes; ++i, ++done_)
      take_facet(bytes_.data() + i * kStlFacetBytes);
    visit_(block_);
    if (visit_attributes_)
      visit_attributes_(attributes_);
  }

  void take_facet(const std::byte* bytes) {
    std::array<double, 9> values{};
    std::optional<std::size_t> bad;  // the first that is no coordinate
    bool is_finite = true;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = double{load<float, kSwap>(bytes + 12 + 4 * i)};
      is_finite = is_finite && std::isfinite(values[i]);
      if (!bad && !is_coordinate(values[i]))
        bad = i;
    }
    if (bad)
      return take_bad_facet(offset() + 12 + 4 * *bad, static_cast<float>(values[*bad]), is_finite);
    attributes_.push_back(load<std::uint16_t, kSwap>(bytes + 48));
    counts_.attributes += attributes_.back() != 0 ? 1 : 0;
    block_.push_back({Vec3d{values[0], values[1], values[2]},
                      Vec3d{values[3], values[4], values[5]},
                      Vec3d{values[6], values[7], values[8]}});
  }

  void take_bad_facet(std::uint64_t offset, float value, bool is_finite) {
    const std::string message = fmt::format("byte {}: expected {} in facet {}, found {}", offset,
                                            kCoordinateRange, done_, value);
    if (is_finite)
      fail_file(path_, message);
    if (counts_.dropped.count++ == 0)
      counts_.dropped.first = file_message(path_, message);
  }

  InputStream& stream_;
  const std::filesystem::path& path_;
  const SoupVisitor& visit_;
  const StlAttributeVisitor& visit_attributes_;
  std::vector<std::byte> bytes_;
  std::vector<SoupTriangle> block_;
  std::vector<std::uint16_t> attributes_;  ///< attributes of the block's facets
  std::uint64_t done_ = 0;
  StlCounts counts_;
};

}  // namespace

bool is_stl_keyword(std::string_view word, std::string_view keyword) {
  return std::ranges::equal(word, keyword, {}, lower);
}

StlCounts read_binary_stl(InputStream& stream, const std::filesystem::path& path,
                          const SoupVisitor& visit, const StlAttributeVisitor& visit_attributes) {
  return BinaryStl(stream, path, visit, visit_attributes).read();
}

class StlTextReader::Impl {
 public:
  Impl(const std::filesystem::path& path, const SoupVisitor& visit, StlSolidVisitor visit_solid)
      : none_({}), words_(none_, path, {}), visit_(visit), visit_solid_(std::move(visit_solid)) {}

  void take(const StlBlock& block) {
    if (!block.is_plain || block.begins_in_solid != in_solid_) {
      TextStream text({block.text.data(), block.text.size()});
      take_rest(text);
      return;
    }
    hand_out(block);
    in_solid_ = block.ends_in_solid;
    counts_.facets += block.facets.size();
    counts_.solids += block.solids.size();
    counts_.fits_float = counts_.fits_float && block.fits_float;
    line_ += block.lines;
  }

  void take_rest(InputStream& rest) {
    words_.go_on(rest, line_);
    while (words_.to_row()) {
      if (in_solid_)
        in_solid_ = read_facet();
      else
        begin_solid();
      if (facets_.size() == kBlockFacets)
        flush();
    }
    flush();
    line_ = words_.line();
  }

  StlCounts finish() {
    if (in_solid_)
      words_.fail("expected 'facet' or 'endsolid', found the end of the file (truncated)");
    return counts_;
  }

 private:
  void hand_out(const StlBlock& block) {
    const std::span<const SoupTriangle> facets(block.facets);
    std::size_t done = 0;
    for (const StlBlock::Solid& solid : block.solids) {
      if (!visit_solid_)
        break;
      visit_(facets.subspan(done, solid.facets - done));
      visit_solid_(solid.name);
      done = solid.facets;
    }
    visit_(facets.subspan(done));
  }

  void flush() {
    visit_(facets_);
    facets_.clear();
  }

  /// Goes to the end of the line that begins a solid.
  void pass_name() {
    if (!visit_solid_)
      return words_.skip_line();
    flush();
    visit_solid_(words_.take_rest(kMostObjectNameBytes));
  }

  void begin_solid() {
    const std::string word(words_.take_word());
    if (counts_.solids > 0 && ends_solid(word)) {
      ++counts_.odd.header_lines;
      return words_.skip_line();
    }
    expect(word, "solid");
    pass_name();
    ++counts_.solids;
    in_solid_ = true;
  }

  /// Returns false at the end of the solid.
  bool read_facet() {
    const std::string word(words_.take_word());
    if (is_stl_keyword(word, "solid")) {
      ++counts_.odd.header_lines;
      pass_name();
      return true;
    }
    if (!is_stl_keyword(word, "facet")) {
      if (!ends_solid(word))
        words_.fail("expected 'facet' or 'endsolid', found " + in_quotes(word));
      words_.skip_line();
      return false;
    }
    words_.skip_line();  // the normal
    expect_row("outer");
    words_.skip_line();
    SoupTriangle facet;
    UnplacedVertices unplaced;
    for (Vec3d& corner : facet)
      corner = read_vertex(unplaced);
    expect_row("endloop");
    expect_row("endfacet");
    unplaced.count > 0 ? drop(unplaced) : facets_.push_back(facet);
    ++counts_.facets;
    return true;
  }

  void drop(const UnplacedVertices& unplaced) {
    if (counts_.dropped.count++ == 0)
      counts_.dropped.first = fmt::format("{} (facet {})", unplaced.first, counts_.facets);
  }

  /// `word` begins the line.
  bool ends_solid(std::string_view word) {
    constexpr std::string_view kEnd = "endsolid";
    if (is_stl_keyword(word.substr(0, kEnd.size()), kEnd))
      return true;
    return is_stl_keyword(word, "end") && words_.to_word() &&
           is_stl_keyword(words_.take_word(), "solid");
  }

  Vec3d read_vertex(UnplacedVertices& unplaced) {
    expect_row("vertex");
    const Vec3d corner = words_.take_position(counts_.fits_float, &unplaced);
    words_.expect_line_end();
    return corner;
  }

  void expect_row(std::string_view keyword) {
    if (!words_.to_row())
      words_.fail(fmt::format("expected '{}', found the end of the file (truncated)", keyword));
    expect(words_.take_word(), keyword);
  }

  void expect(std::string_view word, std::string_view keyword) const {
    if (!is_stl_keyword(word, keyword))
      words_.fail(fmt::format("expected '{}', found {}", keyword, in_quotes(word)));
  }

  TextStream none_;
  WordStream words_;
  const SoupVisitor& visit_;
  StlSolidVisitor visit_solid_;       ///< may be none
  std::vector<SoupTriangle> facets_;  ///< read by words, not handed out yet
  std::uint64_t line_ = 1;
  bool in_solid_ = false;
  StlCounts counts_;
};

StlTextReader::StlTextReader(const std::filesystem::path& path, const SoupVisitor& visit,
                             StlSolidVisitor visit_solid)
    : impl_(std::make_unique<Impl>(path, visit, std::move(visit_solid))) {}
StlTextReader::~StlTextReader() = default;

void StlTextReader::take(const StlBlock& block) {
  impl_->take(block);
}
void StlTextReader::take_rest(InputStream& rest) {
  impl_->take_rest(rest);
}
StlCounts StlTextReader::finish() {
  return impl_->finish();
}

StlCounts read_text_stl(InputStream& stream, const std::filesystem::path& path,
                        const SoupVisitor& visit) {
  LineBlocks blocks(stream, whole_facets);
  StlTextReader reader(path, visit);
  for (StlBlock block; blocks.next(block.text);) {
    parse_facets(block);
    reader.take(block);
  }
  reader.take_rest(blocks.rest());
  return reader.finish();
}

}  // namespace meshhier::mesh_io
