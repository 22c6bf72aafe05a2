// Colours for numbers, and for names.
#pragma once

#include "base/vec.h"

#include <cstdint>
#include <optional>
#include <string_view>

namespace meshhier::render {

/// viridis and cividis (Nunez, Anderton & Renslow 2018) are even to the eye, cividis also to eyes
/// that see few colours; turbo (Mikhailov 2019) tells more steps apart; coolwarm (Moreland 2009)
/// has a middle, for signed values.
enum class ColourRamp : std::uint8_t { viridis, cividis, turbo, coolwarm };

std::optional<ColourRamp> ramp_named(std::string_view name);

/// As light, of a screen's colour 0xRRGGBB.
Vec3d screen_light(std::uint32_t rgb);

/// As light, at `part` of the way, 0 to 1; what lies outside has the colour of that end.
Vec3f ramp_colour(ColourRamp ramp, double part);

/// As light, of the label with that number in the list of all: neighbours in it are far apart.
Vec3f label_colour(std::uint64_t number);

}  // namespace meshhier::render
