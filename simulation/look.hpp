#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::simulation {

/// Red, green and blue in full light, 0 to 1, as a camera delivers them.
using Colour = Eigen::Vector3f;

enum class HairStyle : std::uint8_t { kShort, kLong, kBun };
enum class Emblem : std::uint8_t { kStar, kNumberSeven, kHeart, kRings };

/// Shape and clothes of a built-in person. Left, right, front and back differ in colour: a texture
/// on the wrong side is visible.
struct Look {
    std::string name;
    double height_m = 1.75;
    double girth = 1.0;  // factor on the thickness of trunk and limbs
    HairStyle hair_style = HairStyle::kShort;
    Emblem emblem = Emblem::kStar;
    bool beard = false;
    Colour skin, hair, shirt, back, emblem_colour, sleeve_left, sleeve_right, trousers, stripe,
        shoes;
};

/// Returns nullopt if no look has that name.
std::optional<Look> find_look(std::string_view name);

std::vector<std::string> look_names();

}  // namespace atrium::simulation
