#include "site_node/rig_check/length_mistakes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace atrium::rig_check {
namespace {

struct Unit {
    const char* name;
    const char* plural;
    double metres;
    double rarity;  // in units of the logarithm of a size
};
constexpr std::array<Unit, 5> kUnits{{{"mm", "millimetres", 0.001, 0.0},
                                      {"cm", "centimetres", 0.01, 0.3},
                                      {"m", "metres", 1.0, 0.0},
                                      {"in", "inches", 0.0254, 1.2},
                                      {"ft", "feet", 0.3048, 1.2}}};
// Of lengths that a program has converted: rarer than a wrong key.
constexpr double kConverted = 0.2;
constexpr std::size_t kMostNamed = 3;
constexpr double kMuchOdder = 1.5;  // than the likeliest: not worth naming

bool is_same(double a, double b) { return std::abs(a / b - 1.0) < 1e-6; }

}  // namespace

std::vector<LengthMistake> likely_length_mistakes(double size_m,
                                                  const KnownSize& known,
                                                  double unit_m) {
    std::vector<LengthMistake> found;
    const auto consider = [&](double then_m, double rarity, std::string text, std::string cure) {
        if (then_m < known.smallest_m || then_m > known.largest_m) return;
        const double oddness = rarity + std::abs(std::log(then_m / known.usual_m));
        found.push_back({std::move(text), std::move(cure), then_m, oddness});
    };
    for (const Unit& unit : kUnits) {
        if (is_same(unit.metres, unit_m)) continue;
        consider(size_m / unit_m * unit.metres,
                 unit.rarity,
                 fmt::format("the translations look like {}", unit.plural),
                 fmt::format("write units = \"{}\" if they are", unit.name));
    }
    // a program that writes metres took one unit for another; to take it for metres is the above
    for (const Unit& meant : kUnits) {
        for (const Unit& taken : kUnits) {
            if (!is_same(unit_m, 1.0) || &meant == &taken || is_same(taken.metres, 1.0)) continue;
            consider(size_m / taken.metres * meant.metres,
                     kConverted + meant.rarity + taken.rarity,
                     fmt::format("{} look taken for {}", meant.plural, taken.plural),
                     fmt::format("correct the key units, or import the calibration again with "
                                 "--units {}",
                                 meant.name));
        }
    }
    std::ranges::sort(found, {}, &LengthMistake::oddness);
    return found;
}

std::string explain(const std::vector<LengthMistake>& mistakes, const KnownSize& known) {
    std::string text;
    std::size_t num = 0;
    for (const LengthMistake& mistake : mistakes) {
        if (num > 0 && mistake.cure == mistakes.front().cure) continue;
        if (num == kMostNamed || mistake.oddness > mistakes.front().oddness + kMuchOdder) break;
        text += fmt::format("{}{} ({:.3g} m {} then); {}",
                            num == 0 ? "" : "; or ",
                            mistake.text,
                            mistake.size_m,
                            known.then,
                            mistake.cure);
        ++num;
    }
    return text;
}

}  // namespace atrium::rig_check
