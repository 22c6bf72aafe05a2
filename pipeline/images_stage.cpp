#include "pipeline/images_stage.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "execution/parallel.h"
#include "import/open_picture.h"
#include "pipeline/tiles/texture_store.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

/// A picture of one texel in the place of one that is broken, so that the others keep their
/// numbers.
class NoPicture final : public images::ImageReader {
 public:
  const images::ImageInfo& info() const override { return info_; }
  void read_rows(std::uint8_t* rows, std::uint32_t count) override {
    std::fill_n(rows, std::size_t{count} * info_.channels, std::uint8_t{0});
  }

 private:
  images::ImageInfo info_{ImageFormat::png, 1, 1, 3, 0};
};

/// Passes a picture on and looks for texels that are not opaque.
class AlphaWatch final : public images::ImageReader {
 public:
  explicit AlphaWatch(images::ImageReader& from) : from_(from) {}

  const images::ImageInfo& info() const override { return from_.info(); }
  void read_rows(std::uint8_t* rows, std::uint32_t count) override {
    from_.read_rows(rows, count);
    const std::size_t channels = info().channels;
    if (channels < kAlpha + 1)
      return;
    const std::size_t texels = std::size_t{count} * info().width;
    for (std::size_t i = 0; i < texels && !is_any_; ++i)
      is_any_ = rows[i * channels + kAlpha] != kOpaque;
  }
  bool is_any() const { return is_any_; }

 private:
  static constexpr std::size_t kAlpha = 3;
  static constexpr std::uint8_t kOpaque = 255;
  images::ImageReader& from_;
  bool is_any_ = false;
};

/// Whether a material that shows the picture leaves the meaning of its alpha open.
bool is_alpha_unsaid(std::uint32_t image, const images::MaterialList& materials) {
  return std::ranges::any_of(materials.materials, [&](const images::Material& material) {
    return material.image == image && material.is_alpha_unsaid;
  });
}

/// Warns in one line. `names`: the pictures'.
void warn_of_alpha(const std::vector<std::string>& names, execution::Progress& progress) {
  constexpr std::size_t kMostBytes = 255;
  if (names.empty())
    return;
  const bool is_one = names.size() == 1;
  const std::string first = plain_text(names[0], kMostBytes);
  progress.warn(fmt::format(
      "{} of the mesh {} transparent texels, which are shown opaque ({}{}): if they are holes, add "
      "the line 'map_d {}' to the materials that show {}",
      counted(names.size(), "pictures"), is_one ? "has" : "have",
      is_one ? "" : "the first: ", first, first, is_one ? "it" : "them"));
}

/// Warns in one line.
void warn_of_broken(const std::vector<std::string>& why, execution::Progress& progress) {
  if (why.empty())
    return;
  const bool is_one = why.size() == 1;
  progress.warn(fmt::format(
      "{} of the mesh {} broken ({}{}): triangles show the colour of their material instead",
      counted(why.size(), "pictures"), is_one ? "is" : "are", is_one ? "" : "the first: ", why[0]));
}

}  // namespace

std::vector<std::string> broken_pictures(const TexturePlan& plan, const BuildJournal& journal) {
  std::vector<std::string> why = plan.broken;
  for (const BrokenImage& image : journal.broken_images())
    why.push_back(image.second);
  return why;
}

namespace {

/// A picture on its way into the store.
struct Decoded {
  images::StoredImage stored;
  std::string broken;  ///< why it could not be decoded; empty: it is sound
  bool has_unsaid_alpha = false;
};

Decoded decode(std::uint32_t image, const images::ImageStore& pictures,
               const StageContext& context) {
  const images::MaterialList& materials = context.plan.textures.materials;
  const auto step = [&](std::uint64_t texels) {
    context.cancel.check();
    context.progress.advance(texels);
  };
  Decoded decoded;
  try {
    const auto reader = importing::open_picture(materials.images[image], context.files.input());
    if (!is_alpha_unsaid(image, materials)) {
      decoded.stored = pictures.write(*reader, step);
      return decoded;
    }
    AlphaWatch watch(*reader);
    decoded.stored = pictures.write(watch, step);
    decoded.has_unsaid_alpha = watch.is_any();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input)
      throw;
    if (context.config.missing_images != config::MissingImages::ignore)
      throw with_picture_hint(error);
    decoded.broken = error.what();
    NoPicture none;
    decoded.stored = pictures.write(none, step);
  }
  return decoded;
}

}  // namespace

void decode_images(images::ImageStore& pictures, BuildJournal& journal,
                   const StageContext& context) {
  const TexturePlan& plan = context.plan.textures;
  const std::size_t first = pictures.size();
  std::uint64_t left = 0;
  for (std::size_t i = first; i < plan.heads.size(); ++i)
    left += std::uint64_t{plan.heads[i].width} * plan.heads[i].height;
  context.progress.stage("images", left, "texels");
  std::vector<std::string> transparent;
  execution::ordered_for(
      plan.heads.size() - std::min(first, plan.heads.size()), context.memory().pictures_in_flight,
      context.cancel,
      [&](std::size_t i) {
        return decode(static_cast<std::uint32_t>(first + i), pictures, context);
      },
      [&](std::size_t i, Decoded decoded) {
        const std::size_t image = first + i;
        plan.check_unchanged(image, context.files);
        journal.note_image(decoded.stored, decoded.broken);
        pictures.add(std::move(decoded.stored));
        if (decoded.has_unsaid_alpha)
          transparent.push_back(plan.materials.images[image].name);
      });
  warn_of_broken(broken_pictures(plan, journal), context.progress);
  warn_of_alpha(transparent, context.progress);
}

images::MaterialList shown_materials(const TexturePlan& plan, const BuildJournal& journal) {
  images::MaterialList materials = plan.materials;
  for (const auto& [image, why] : journal.broken_images())
    leave_out(image, materials);
  return materials;
}

StageMemory images_memory(const JobSize& job) {
  const std::uint64_t item = job.decoder_bytes + job.adding_bytes;
  return {item, job.threads, item, job.threads * item, &MemoryPlan::pictures_in_flight};
}

StageTimes images_time(const JobSize& job, const TilePopulation& /*tiles*/) {
  constexpr double kTexelSeconds = 20e-9;
  return {{"images", "texels", job.source_texels,
           static_cast<double>(job.source_texels) * kTexelSeconds}};
}

DiskVolumes images_disk(const JobSize& job, const TilePopulation& /*tiles*/,
                        const MemoryPlan& /*memory*/) {
  return {{static_cast<double>(job.picture_bytes), DiskMoment::leaves, DiskMoment::simplify}};
}

}  // namespace meshhier::pipeline
