#include "pipeline/journal/input_json.h"

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

TEST(MaterialJsonTest, AListComesBack) {
  images::MaterialList list;
  list.images.push_back({"a b.jpg", "/scans/\xff/a b.jpg", 0, 0, {}});
  list.images.push_back({"inside", "/scans/one.glb", 1000, 77, {}});
  list.images.push_back({"data", {}, 0, 0, {std::byte{1}, std::byte{255}}});
  list.images.push_back({"packed", "/scans/one.b3dm", 1000, 77, {}, true});
  images::Material wall{.name = "wall \xc3\xa4",
                        .colour = {0.25f, 1, 0, 0.5f},
                        .image = 1,
                        .factor = {1, 0.5f, 0.25f, 0},
                        .light = {0, 0.5f, 0.125f},
                        .wrap_u = Wrap::mirrored,
                        .wrap_v = Wrap::clamp,
                        .alpha = AlphaMode::blend,
                        .alpha_cutoff = 0.25f,
                        .is_alpha_unsaid = true};
  list.materials = {wall, images::Material{}};
  EXPECT_EQ(material_list(to_json(list)), list);
  EXPECT_EQ(material_list(to_json(images::MaterialList{})), images::MaterialList{});
  const nlohmann::json stored = nlohmann::json::from_cbor(nlohmann::json::to_cbor(to_json(list)));
  EXPECT_EQ(material_list(stored), list);
}

TEST(MaterialJsonTest, WhatIsNoListIsRefused) {
  EXPECT_THROW(material_list(nlohmann::json::object()), nlohmann::json::exception);
  EXPECT_THROW(material_list({{"images", {{{"name", "a"}}}}, {"materials", {}}}),
               nlohmann::json::exception);
}

}  // namespace
}  // namespace meshhier::pipeline
