#include "simulation/look.hpp"

namespace atrium::simulation {
namespace {

// 0xRRGGBB
Colour colour(std::uint32_t rgb) {
    return Colour(static_cast<float>((rgb >> 16) & 0xff),
                  static_cast<float>((rgb >> 8) & 0xff),
                  static_cast<float>(rgb & 0xff)) /
           255.0f;
}

std::vector<Look> all_looks() {
    return {
        {.name = "ada",
         .height_m = 1.70,
         .girth = 0.94,
         .hair_style = HairStyle::kLong,
         .emblem = Emblem::kStar,
         .skin = colour(0xe2b08e),
         .hair = colour(0x3a2218),
         .shirt = colour(0xf0b422),
         .back = colour(0xb5420f),
         .emblem_colour = colour(0xa01c3c),
         .sleeve_left = colour(0x1f9aa0),
         .sleeve_right = colour(0xc8322b),
         .trousers = colour(0x22305e),
         .stripe = colour(0x6e86d6),
         .shoes = colour(0xe6e2dc)},
        {.name = "ben",
         .height_m = 1.82,
         .girth = 1.0,
         .hair_style = HairStyle::kShort,
         .emblem = Emblem::kNumberSeven,
         .skin = colour(0xd19a76),
         .hair = colour(0x5d3c1f),
         .shirt = colour(0x2458b8),
         .back = colour(0x173a2a),
         .emblem_colour = colour(0xf4f2ea),
         .sleeve_left = colour(0xf0ede2),
         .sleeve_right = colour(0xe07a1c),
         .trousers = colour(0x3b3128),
         .stripe = colour(0xd8a23c),
         .shoes = colour(0xb52a24)},
        {.name = "mira",
         .height_m = 1.75,
         .girth = 0.96,
         .hair_style = HairStyle::kBun,
         .emblem = Emblem::kHeart,
         .skin = colour(0x9a6446),
         .hair = colour(0x8e2a14),
         .shirt = colour(0x2f9a52),
         .back = colour(0x6a2a86),
         .emblem_colour = colour(0xf6d8e0),
         .sleeve_left = colour(0xf2d230),
         .sleeve_right = colour(0xd43a86),
         .trousers = colour(0x2a2238),
         .stripe = colour(0x3fb8c8),
         .shoes = colour(0xf0d24a)},
        {.name = "otto",
         .height_m = 1.78,
         .girth = 1.13,
         .hair_style = HairStyle::kShort,
         .emblem = Emblem::kRings,
         .beard = true,
         .skin = colour(0xe6bc9e),
         .hair = colour(0xcfcbc4),
         .shirt = colour(0xb02a34),
         .back = colour(0x23476e),
         .emblem_colour = colour(0xf4e6b8),
         .sleeve_left = colour(0x2b6cc4),
         .sleeve_right = colour(0x5aa83a),
         .trousers = colour(0x2d4038),
         .stripe = colour(0xe8e0c8),
         .shoes = colour(0x3a2418)},
    };
}

}  // namespace

std::optional<Look> find_look(std::string_view name) {
    for (const Look& look : all_looks()) {
        if (look.name == name) return look;
    }
    return std::nullopt;
}

std::vector<std::string> look_names() {
    std::vector<std::string> names;
    for (const Look& look : all_looks()) names.push_back(look.name);
    return names;
}

}  // namespace atrium::simulation
