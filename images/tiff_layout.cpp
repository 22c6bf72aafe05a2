#include "images/tiff_layout.h"

#include "storage/io/little_endian.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace meshhier::images {
namespace {

enum TiffType : std::uint16_t { kAscii = 2, kShort = 3, kLong = 4, kDouble = 12, kLong8 = 16 };

template <class Value>
TiffField field_of(std::uint16_t tag, TiffType type, std::span<const Value> values) {
  TiffField field{tag, type, values.size(), std::vector<std::byte>(values.size_bytes())};
  storage::store_all_little(values, field.bytes.data());
  return field;
}

/// How offsets are written: as in TIFF 6.0, or as in BigTIFF.
struct TiffForm {
  bool is_big = false;

  std::size_t header_bytes() const { return is_big ? 16 : 8; }
  std::size_t count_bytes() const { return is_big ? 8 : 2; }  ///< of the number of entries
  std::size_t offset_bytes() const { return is_big ? 8 : 4; }
  std::size_t entry_bytes() const { return 4 + 2 * offset_bytes(); }

  void append(std::vector<std::byte>& to, std::uint64_t offset) const {
    if (is_big)
      storage::append_little(to, offset);
    else
      storage::append_little(to, static_cast<std::uint32_t>(offset));
  }
};

/// Returns the entries with their values behind them; `at`: where that will lie. The next
/// directory, if there is one, comes right behind.
std::vector<std::byte> directory_bytes(const TiffForm& form, const std::vector<TiffField>& fields,
                                       std::uint64_t at, bool is_last) {
  std::vector<std::byte> entries, values;
  if (form.is_big)
    storage::append_little(entries, static_cast<std::uint64_t>(fields.size()));
  else
    storage::append_little(entries, static_cast<std::uint16_t>(fields.size()));
  const std::uint64_t values_at =
      at + form.count_bytes() + fields.size() * form.entry_bytes() + form.offset_bytes();
  for (const TiffField& field : fields) {
    storage::append_little(entries, field.tag);
    storage::append_little(entries, field.type);
    form.append(entries, field.count);
    std::vector<std::byte> own = field.bytes;
    if (own.size() <= form.offset_bytes()) {
      own.resize(form.offset_bytes());
      entries.insert(entries.end(), own.begin(), own.end());
      continue;
    }
    form.append(entries, values_at + values.size());
    own.resize((own.size() + 7) / 8 * 8);
    values.insert(values.end(), own.begin(), own.end());
  }
  form.append(entries, is_last ? 0 : values_at + values.size());
  entries.insert(entries.end(), values.begin(), values.end());
  return entries;
}

TiffField long_field(std::uint16_t tag, std::uint32_t value) {
  return tiff_longs(tag, {{value}});
}
TiffField short_field(std::uint16_t tag, std::uint16_t value) {
  return tiff_shorts(tag, {{value}});
}
TiffField long_fields(std::uint16_t tag, std::span<const std::uint64_t> values) {
  return tiff_longs(tag, std::vector<std::uint32_t>(values.begin(), values.end()));
}

TiffField offsets_field(const TiffForm& form, const TiffRaster& raster, std::uint64_t first) {
  constexpr std::uint16_t kTileOffsets = 324;
  std::vector<std::uint64_t> offsets;
  for (const std::uint64_t bytes : raster.tile_bytes)
    offsets.push_back(std::exchange(first, first + bytes));
  return form.is_big ? field_of<std::uint64_t>(kTileOffsets, kLong8, offsets)
                     : long_fields(kTileOffsets, offsets);
}

/// Returns the entries of a raster whose tiles begin at `first_tile`, ascending by tag.
std::vector<TiffField> fields_of(const TiffForm& form, TiffPixel kind, const TiffRaster& raster,
                                 bool is_overview, std::uint64_t first_tile) {
  constexpr std::uint16_t kRgb = 2, kBlackIsZero = 1, kDeflate = 8, kFloat = 3, kUnassociated = 2;
  const bool is_rgba = kind == TiffPixel::rgba;
  std::vector<TiffField> fields;
  if (is_overview)
    fields.push_back(long_field(254, 1));  // NewSubfileType: a smaller one
  const std::vector<std::uint16_t> bits(is_rgba ? 4 : 1, is_rgba ? 8 : 32);
  const std::vector<TiffField> more{
      long_field(256, raster.width),
      long_field(257, raster.height),
      tiff_shorts(258, bits),  // BitsPerSample
      short_field(259, kDeflate),
      short_field(262, is_rgba ? kRgb : kBlackIsZero),
      short_field(277, is_rgba ? 4 : 1),  // SamplesPerPixel
      short_field(284, 1),                // PlanarConfiguration: all of a pixel side by side
      short_field(317, is_rgba ? 2 : 3),  // Predictor
      long_field(322, kTiffTileSide),
      long_field(323, kTiffTileSide),
      offsets_field(form, raster, first_tile),
      long_fields(325, raster.tile_bytes)};  // TileByteCounts
  fields.insert(fields.end(), more.begin(), more.end());
  if (is_rgba)
    fields.push_back(short_field(338, kUnassociated));  // ExtraSamples
  else
    fields.push_back(short_field(339, kFloat));  // SampleFormat
  return fields;
}

std::uint64_t sum_of(const TiffRaster& raster) {
  return std::reduce(raster.tile_bytes.begin(), raster.tile_bytes.end(), std::uint64_t{0});
}

/// `tiles_at`: where the first tile will lie.
std::vector<std::byte> head_bytes(const TiffForm& form, TiffPixel kind,
                                  std::span<const TiffRaster> rasters,
                                  std::span<const TiffField> fields, std::uint64_t tiles_at) {
  constexpr std::uint16_t kClassic = 42, kBig = 43;
  std::vector<std::byte> head{std::byte{'I'}, std::byte{'I'}};
  storage::append_little(head, form.is_big ? kBig : kClassic);
  if (form.is_big)
    storage::append_little(head, std::uint32_t{8});  // bytes of an offset
  form.append(head, form.header_bytes());
  std::uint64_t end = tiles_at;
  for (const TiffRaster& raster : rasters)
    end += sum_of(raster);
  for (std::size_t i = 0; i < rasters.size(); ++i) {
    end -= sum_of(rasters[i]);  // the first one's are the last
    std::vector<TiffField> all = fields_of(form, kind, rasters[i], i > 0, end);
    if (i == 0)
      all.insert(all.end(), fields.begin(), fields.end());
    std::ranges::sort(all, {}, &TiffField::tag);
    const std::vector<std::byte> directory =
        directory_bytes(form, all, head.size(), i + 1 == rasters.size());
    head.insert(head.end(), directory.begin(), directory.end());
  }
  return head;
}

}  // namespace

TiffField tiff_shorts(std::uint16_t tag, std::span<const std::uint16_t> values) {
  return field_of(tag, kShort, values);
}
TiffField tiff_longs(std::uint16_t tag, std::span<const std::uint32_t> values) {
  return field_of(tag, kLong, values);
}
TiffField tiff_doubles(std::uint16_t tag, std::span<const double> values) {
  return field_of(tag, kDouble, values);
}
TiffField tiff_text(std::uint16_t tag, std::string_view text) {
  TiffField field{tag, kAscii, text.size() + 1, std::vector<std::byte>(text.size() + 1)};
  std::ranges::transform(text, field.bytes.begin(),
                         [](char c) { return static_cast<std::byte>(c); });
  return field;
}

std::vector<std::byte> tiff_head(TiffPixel kind, std::span<const TiffRaster> rasters,
                                 std::span<const TiffField> fields) {
  std::uint64_t tiles = 0;
  for (const TiffRaster& raster : rasters)
    tiles += sum_of(raster);
  TiffForm form;
  const std::size_t bytes = head_bytes(form, kind, rasters, fields, 0).size();
  form.is_big = bytes + tiles > std::numeric_limits<std::uint32_t>::max();
  return head_bytes(form, kind, rasters, fields, head_bytes(form, kind, rasters, fields, 0).size());
}

}  // namespace meshhier::images
