#include "pipeline/plan/texture_plan.h"

#include "base/error.h"
#include "images/image_store.h"
#include "import/open_picture.h"

#include <algorithm>
#include <utility>

namespace meshhier::pipeline {
std::uint64_t TexturePlan::texels() const {
  std::uint64_t sum = 0;
  for (const images::ImageInfo& head : heads)
    sum += std::uint64_t{head.width} * head.height;
  return sum;
}

std::uint64_t TexturePlan::stored_bytes() const {
  std::uint64_t sum = 0;
  for (const images::ImageInfo& head : heads)
    sum += images::ImageStore::stored_bytes(head.width, head.height, head.channels);
  return sum;
}

std::uint64_t TexturePlan::decoder_bytes() const {
  std::uint64_t most = 0;
  for (const images::ImageInfo& head : heads)
    most = std::max(most, head.decoder_bytes);
  return most;
}

std::uint64_t TexturePlan::adding_bytes() const {
  std::uint64_t most = 0;
  for (const images::ImageInfo& head : heads)
    most = std::max(most, images::ImageStore::adding_bytes(head.width, head.height, head.channels));
  return most;
}

void TexturePlan::check_unchanged(std::size_t image, storage::FileSystem& files) const {
  const images::ImageSource& source = materials.images[image];
  if (!source.file.empty() && files.input().identity(source.file) != identities[image]) {
    throw Error(ErrorCode::input,
                source.file.string() + " was changed while it was read; build it again");
  }
}

void leave_out(std::uint32_t image, images::MaterialList& materials) {
  for (images::Material& material : materials.materials) {
    if (material.image == image)
      material.image.reset();
  }
}

Error with_picture_hint(const Error& broken) {
  return {broken.code(), std::string(broken.what()) +
                             "; convert the picture, or leave out what is broken by "
                             "\"missing_images\": \"ignore\""};
}

TexturePlan plan_textures(images::MaterialList materials, config::MissingImages missing,
                          storage::FileSystem& files) {
  TexturePlan plan;
  plan.materials.materials = std::move(materials.materials);
  for (std::uint32_t i = 0; i < materials.images.size(); ++i) {
    try {
      const auto picture = importing::open_picture(materials.images[i], files.input());
      if (const std::string why = picture->missing(); !why.empty())
        throw Error(ErrorCode::io, materials.images[i].name + ": " + why);
      plan.heads.push_back(picture->info());
    } catch (const Error& error) {
      if (error.code() != ErrorCode::input)
        throw;
      if (missing != config::MissingImages::ignore)
        throw with_picture_hint(error);
      plan.broken.emplace_back(error.what());
      leave_out(static_cast<std::uint32_t>(plan.heads.size()), plan.materials);
      for (images::Material& material : plan.materials.materials) {
        if (material.image && *material.image > plan.heads.size())
          --*material.image;  // the pictures behind it move up
      }
      continue;
    }
    const std::filesystem::path& file = materials.images[i].file;
    plan.identities.push_back(file.empty() ? storage::FileIdentity()
                                           : files.input().identity(file));
    plan.materials.images.push_back(std::move(materials.images[i]));
  }
  return plan;
}

}  // namespace meshhier::pipeline
