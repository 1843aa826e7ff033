#pragma once

#include <string>
#include <vector>

namespace atrium::rig_check {

/// The size of a thing that the rig's lengths make too large or too small, for example a room.
struct KnownSize {
    const char* then;  // what the corrected size is of, for messages
    double usual_m;
    double smallest_m;  // that is plausible
    double largest_m;
};
inline constexpr KnownSize kRoomWidth{"from camera to camera", 5.0, 1.2, 25.0};
inline constexpr KnownSize kPersonHeight{"tall", 1.6, 0.6, 2.6};

/// A mistake with units that explains a wrong size.
struct LengthMistake {
    std::string text;      // "the translations look like millimetres"
    std::string cure;      // "write units = \"mm\""
    double size_m = 0.0;   // then
    double oddness = 0.0;  // the less the likelier
};

/// Finds the mistakes that make `size_m` plausible, the likeliest first: another unit than the key
/// `units` of the rig says (`unit_m`), or, in a rig in metres, lengths that a program converted
/// from a wrong unit. Lengths in mm and m are commoner than in cm, and those than in inches and
/// feet.
std::vector<LengthMistake> likely_length_mistakes(double size_m,
                                                  const KnownSize& known,
                                                  double unit_m);

/// Up to three of them as one sentence, with the sizes that they give; empty without any.
std::string explain(const std::vector<LengthMistake>& mistakes, const KnownSize& known);

}  // namespace atrium::rig_check
