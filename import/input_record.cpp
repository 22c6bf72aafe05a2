#include "import/input_record.h"

#include "base/named_value.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

constexpr std::array kParts{NamedValue{"mesh", InputPart::mesh},
                            NamedValue{"buffer", InputPart::buffer},
                            NamedValue{"material library", InputPart::library},
                            NamedValue{"picture", InputPart::picture},
                            NamedValue{"tileset", InputPart::tileset},
                            NamedValue{"tile", InputPart::tile},
                            NamedValue{"object table", InputPart::table}};

/// Joins the files of a part, one or more.
SourceFile joined(std::span<const ReadFile> files) {
  SourceFile all;
  all.name = files[0].path.filename().string();
  all.format = name_in(kParts, files[0].part);
  std::vector<std::uint64_t> checksums;
  for (const ReadFile& file : files) {
    all.bytes += file.identity.bytes;
    checksums.push_back(file.checksum);
  }
  if (files.size() > 1)
    all.name += fmt::format(" and {} more", files.size() - 1);
  all.checksum = joined_checksum(checksums);
  return all;
}

}  // namespace

void CompanionFiles::add(CompanionFile file) {
  if (known_.insert(file.path).second)
    files_.push_back(std::move(file));
}

void CompanionFiles::await(const std::vector<std::filesystem::path>& places) {
  for (const std::filesystem::path& place : places) {
    if (known_places_.insert(place).second)
      awaited_.push_back(place);
  }
}

void CompanionFiles::add_all(const CompanionFiles& others) {
  for (const CompanionFile& file : others.files_)
    add(file);
  await(others.awaited_);
}

std::vector<SourceFile> source_files(const std::vector<ReadFile>& files,
                                     const std::vector<std::string>& formats) {
  std::span<const ReadFile> left(files);
  const std::size_t listed =
      formats.size() <= kMostListedMeshes ? formats.size() : kMostListedMeshes - 1;
  std::vector<SourceFile> all;
  for (std::size_t i = 0; i < listed; ++i) {
    const ReadFile& mesh = files[i];
    all.push_back({mesh.path.filename().string(), formats[i], mesh.identity.bytes, mesh.checksum});
  }
  left = left.subspan(listed);
  while (!left.empty()) {
    const auto end = std::ranges::upper_bound(left, left[0].part, {}, &ReadFile::part);
    const auto count = static_cast<std::size_t>(end - left.begin());
    all.push_back(joined(left.first(count)));
    left = left.subspan(count);
  }
  return all;
}

void add_count(std::vector<SourceCount>& counts, std::string_view name, std::uint64_t count) {
  if (count == 0)
    return;
  const auto found = std::ranges::find(counts, name, &SourceCount::name);
  if (found == counts.end())
    counts.push_back({std::string(name), count});
  else
    found->count += count;
}

std::vector<SourceCount> source_counts(const mesh_io::PolygonCounts& polygons) {
  std::vector<SourceCount> counts{{"concave_polygons", polygons.concave},
                                  {"crossed_polygons", polygons.crossed},
                                  {"unchecked_polygons", polygons.unchecked}};
  std::erase_if(counts, [](const SourceCount& one) { return one.count == 0; });
  return counts;
}

std::vector<SourceCount> source_counts(const mesh_io::ZeroedCounts& zeroed) {
  std::vector<SourceCount> counts;
  add_count(counts, kZeroedNormals, zeroed.normals);
  add_count(counts, kRounded, zeroed.rounded);
  add_count(counts, kZeroedTexcoords, zeroed.texcoords);
  return counts;
}

std::vector<SourceCount> source_counts(const mesh_io::OddSyntax& odd) {
  std::vector<SourceCount> counts;
  add_count(counts, "ignored_bytes_behind", odd.bytes_behind);
  add_count(counts, "ignored_lines_behind", odd.lines_behind);
  add_count(counts, "integers_written_as_floats", odd.integers);
  add_count(counts, "odd_header_lines", odd.header_lines);
  add_count(counts, kRounded, odd.rounded);
  add_count(counts, "rows_over_several_lines", odd.broken_rows);
  return counts;
}

bool shows_materials(const SourceSummary& source) {
  if (source.textures || std::ranges::any_of(source.counts, [](const SourceCount& one) {
        return one.name == kMaterialColours;
      }))
    return true;
  const auto is_of = [](const SourceFile& file, InputPart part) {
    return file.format == name_in(kParts, part);
  };
  return std::ranges::any_of(source.files, [&](const SourceFile& file) {
    return is_of(file, InputPart::library) || is_of(file, InputPart::picture);
  });
}

std::uint64_t joined_checksum(const std::vector<std::uint64_t>& checksums) {
  if (checksums.size() == 1)
    return checksums[0];
  storage::Checksum sum;
  for (std::uint64_t checksum : checksums) {
    std::array<std::byte, 8> bytes{};
    for (std::byte& byte : bytes) {
      byte = static_cast<std::byte>(checksum);
      checksum >>= 8;
    }
    sum.add(bytes);
  }
  return sum.value();
}

std::uint64_t joined_checksum(const std::vector<SourceFile>& files) {
  std::vector<std::uint64_t> checksums;
  for (const SourceFile& file : files)
    checksums.push_back(file.checksum);
  return joined_checksum(checksums);
}

}  // namespace meshhier::importing
