#include "verify/input_use.h"

#include "base/error.h"
#include "config/config.h"
#include "export/manifest_config.h"
#include "import/input_record.h"
#include "mesh_io/formats.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

/// Says that the label that objects are made from is read, also where it is not kept besides.
void read_object_label(importing::InputUse& use) {
  const std::string& label = use.objects.label;
  if (label.empty() || use.attributes.takes(label))
    return;
  use.attributes.names.push_back(label);
  if (use.attributes.labels)
    use.attributes.labels->push_back(label);
}

/// Returns the use of the input as in the build. A config that is none is told elsewhere.
importing::InputUse use_of(const storage::Manifest& manifest) {
  importing::InputUse use;
  use.attributes = {.which = mesh_io::AttributeChoice::Which::named, .labels = {{}}};
  use.objects.from = mesh_io::ObjectSource::none;
  bool has_objects = false;
  for (const ScalarAttribute& value : manifest.source.attributes.values) {
    has_objects = has_objects || value.is_object;
    if (value.is_object)
      continue;
    use.attributes.names.push_back(value.name);
    if (value.is_label)
      use.attributes.labels->push_back(value.name);
  }
  use.textures = importing::shows_materials(manifest.source) ? importing::Textures::use
                                                             : importing::Textures::ignore;
  try {
    const config::Config config = exporting::config_of(manifest);
    use.weld = config.weld;
    use.crop = config.crop_box();
    if (has_objects)
      use.objects = config.objects.from;
    // Values of faces have split vertices even where the mesh has not kept them.
    if (manifest.source.count_of("dropped_values") > 0)
      use.attributes = config.attributes;
    read_object_label(use);
    use.crs = config.placement.crs.value_or("");
  } catch (const Error&) {
  }
  return use;
}

/// Takes the file of that name out of the inputs; if it is not there, it is beside the first one.
/// `what`: for the message if it is not there either.
std::filesystem::path take_named(const VerifyJob& job, const std::string& name,
                                 std::string_view what, mesh_io::InputPaths& inputs) {
  const auto named = std::ranges::find_if(
      inputs, [&](const std::filesystem::path& path) { return path.filename() == name; });
  if (named == inputs.end()) {
    std::filesystem::path beside = inputs[0].parent_path() / name;
    if (job.files.input().kind(beside) != storage::FileKind::regular)
      throw Error(ErrorCode::usage, fmt::format("{}: {} of the hierarchy is not there; name it by "
                                                "another --input",
                                                beside.string(), what));
    return beside;
  }
  std::filesystem::path found = *named;
  inputs.erase(named);
  return found;
}

/// Takes the orthophoto of heights out of the inputs, or finds it beside the first of them: the
/// manifest tells its name. Returns "" if there is none.
std::filesystem::path take_drape(const VerifyJob& job, mesh_io::InputPaths& inputs) {
  const auto& made_of = job.reader.manifest().source.files;
  const auto is_raster = [](const SourceFile& file) {
    return std::ranges::any_of(mesh_io::format_rows(), [&](const mesh_io::FormatRow& row) {
      return row.is_raster && row.name == file.format;
    });
  };
  const auto picture = std::ranges::find(made_of, "picture", &SourceFile::format);
  if (picture == made_of.end() || inputs.empty() || std::ranges::none_of(made_of, is_raster))
    return {};
  return take_named(job, picture->name, "the orthophoto", inputs);
}

/// Takes the table of objects in the same way.
std::filesystem::path take_object_table(const VerifyJob& job, mesh_io::InputPaths& inputs) {
  const auto& made_of = job.reader.manifest().source.files;
  const auto table = std::ranges::find(made_of, "object table", &SourceFile::format);
  return table == made_of.end() || inputs.empty()
             ? std::filesystem::path()
             : take_named(job, table->name, "the table of objects", inputs);
}

}  // namespace

importing::InputUse take_input_use(const VerifyJob& job, mesh_io::InputPaths& inputs) {
  importing::InputUse use = use_of(job.reader.manifest());
  use.drape = take_drape(job, inputs);
  use.object_table = take_object_table(job, inputs);
  return use;
}

}  // namespace meshhier::verifying
