#include "inspection/drawn_view.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "inspection/kept_view.h"
#include "render/shown_view.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::inspection {
namespace {

/// What options say holds instead.
void take_options(const PreviewOptions& options, UpAxis of_file, ModelView& view) {
  const Vec3d upwards = render::standing_of(view, of_file).upwards();
  if (options.up)
    view.up = *options.up == UpAxis::z ? "z" : "y";
  if (render::standing_of(view, of_file).upwards() != upwards)
    view.camera.clear();  // it is kept in a world that is turned otherwise
  if (options.view || (options.region.is_any() && options.link.empty()))
    view.camera.clear();
  if (options.selection)
    view.level.reset();
  if (options.attribute || options.objects) {
    view.colours = ModelView{}.colours;
    view.by.clear();
  }
}

/// Warns of a name that the page takes for the first attribute.
void warn_of_attribute(const storage::HierarchyReader& reader, const ModelView& view,
                       execution::Progress& progress) {
  const auto& values = reader.manifest().source.attributes.values;
  const bool is_there =
      std::ranges::find(values, view.attribute, &ScalarAttribute::name) != values.end();
  if (view.colours != "attribute" || view.attribute.empty() || is_there)
    return;
  progress.warn(
      fmt::format("the view shows the attribute {}, which the hierarchy does not have: {}",
                  plain_text(view.attribute, kMostNameBytes),
                  values.empty() ? "colours are its own" : values.front().name + " is shown"));
}

std::size_t longest_of(std::span<const std::string> texts, std::string_view name) {
  std::size_t longest = 0;
  for (const std::string& text : texts) {
    if (text == name || (text.ends_with('/') && name.starts_with(text)))
      longest = std::max(longest, text.size());
  }
  return longest;
}

bool is_shown(const ModelView& view, std::string_view name) {
  const std::size_t out = longest_of(view.hide, name), back = longest_of(view.show, name);
  if (out == 0 && back == 0)
    return view.only.empty() || longest_of(view.only, name) > 0;
  return back > out;
}

}  // namespace

DrawnView drawn_view(const storage::HierarchyReader& reader, const PreviewOptions& options,
                     execution::Progress& progress) {
  DrawnView drawn{reader.manifest().view};
  if (!options.link.empty()) {
    constexpr std::size_t kShownBytes = 200;
    const LinkedView link = view_of_link(options.link, reader.manifest().view);
    drawn.view = link.view;
    if (!link.others.empty())
      progress.warn(
          fmt::format("the picture does not show of the link: {}",
                      plain_text(fmt::format("{}", fmt::join(link.others, ", ")), kShownBytes)));
  }
  drawn.is_plain = options.link.empty() && drawn.view.empty();
  if (drawn.is_plain)
    return drawn;
  take_options(options, reader.manifest().up, drawn.view);
  drawn.has_pose = !options.view && (!options.link.empty() || !drawn.view.camera.empty());
  warn_of_attribute(reader, drawn.view, progress);
  drawn.view = render::known_view(drawn.view, reader.manifest().source);
  if (const std::string left = render::not_drawn(drawn.view); !left.empty())
    progress.warn("the picture does not show of the view: " + left);
  return drawn;
}

std::optional<std::vector<std::uint32_t>> shown_objects(const storage::HierarchyReader& reader,
                                                        const ModelView& view,
                                                        const execution::CancelToken& cancel) {
  if (view.only.empty() && view.hide.empty() && view.show.empty())
    return std::nullopt;
  std::vector<std::uint32_t> numbers;
  reader.open_objects()->for_each([&](std::uint32_t object, const ObjectRow& row) {
    cancel.check();
    if (is_shown(view, row.name))
      numbers.push_back(object);
  });
  if (numbers.empty())
    throw Error(ErrorCode::usage, "the view shows none of the hierarchy's objects");
  return numbers;
}

}  // namespace meshhier::inspection
