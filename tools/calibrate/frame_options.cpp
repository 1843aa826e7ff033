#include "tools/calibrate/frame_options.hpp"

#include "tools/calibrate/formats/data_tree.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"

#include <fmt/format.h>

#include <charconv>
#include <utility>
#include <vector>

namespace atrium::calibrate {
namespace {

// "237" is a height in centimetres rather than in metres.
std::string hint_of_centimetres(const std::string& text) {
    const auto height_cm = parse_number(text, 0.0, 1000.0);
    return height_cm ? fmt::format("; if you gave centimetres, write {:.4g}", *height_cm / 100.0)
                     : std::string();
}

}  // namespace

std::optional<double> parse_number(const std::string& text, double low, double high) {
    double value = 0.0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_good =
        failure == std::errc{} && end == text.data() + text.size() && value >= low && value <= high;
    return is_good ? std::optional(value) : std::nullopt;
}

// "3,18" is 3.18.
std::string hint_of_comma(const std::string& text) {
    const std::string word = decimal_comma(text);
    return word.empty() ? std::string() : "; write a decimal point: " + with_points(word);
}

std::array<int, 2> parse_size(const std::string& text, const char* option) {
    const std::size_t x = text.find('x');
    const auto width = parse_number(text.substr(0, x), 16, 8192);
    const auto height = parse_number(x == std::string::npos ? "" : text.substr(x + 1), 16, 8192);
    if (!width || !height)
        throw CLI::ValidationError(option, "must be WIDTHxHEIGHT, 16 to 8192 px, got " + text);
    return {static_cast<int>(*width), static_cast<int>(*height)};
}

void add_up_option(CLI::App& command, Said& said) {
    command
        .add_option("--up",
                    said.up,
                    "axis of the file that points up, or a direction in the file's axes such as "
                    "0.05,-0.99,0.1; default: found out")
        ->type_name("+X|-X|+Y|-Y|+Z|-Z|X,Y,Z")
        ->check(CLI::Validator(
            [](std::string& word) {
                return up_vector(word).isZero()
                           ? "must be +X, -X, +Y, -Y, +Z or -Z, or a direction in the "
                             "file's axes such as 0.05,-0.99,0.1, got " +
                                 word
                           : std::string();
            },
            ""));
}

void add_distance_options(CLI::App& command, Said& said) {
    command
        .add_option_function<std::vector<std::string>>(
            "--distance",
            [&said](const std::vector<std::string>& words) {
                const auto metres = parse_number(words[2], 0.01, 1000.0);
                if (!metres)
                    throw CLI::ValidationError("--distance",
                                               "must be two cameras and 0.01 to 1000 metres, got " +
                                                   words[2] + hint_of_comma(words[2]));
                said.distance = Said::Distance{words[0], words[1], *metres};
            },
            "measured distance of two cameras in metres; gives the scale")
        ->expected(3)
        ->type_name("CAMERA CAMERA METRES");
    command
        .add_option_function<std::vector<std::pair<std::string, std::string>>>(
            "--camera-height",
            [&said](const std::vector<std::pair<std::string, std::string>>& pairs) {
                for (const auto& [camera, text] : pairs) {
                    const auto metres = parse_number(text, -10.0, 100.0);
                    if (!metres)
                        throw CLI::ValidationError("--camera-height",
                                                   "must be a camera and -10 to 100 metres, got " +
                                                       text + hint_of_centimetres(text) +
                                                       hint_of_comma(text));
                    said.heights.push_back({camera, *metres});
                }
            },
            "measured height of a camera above the floor in metres; gives the floor. Given for "
            "three or more cameras that stand on no line, it also gives up")
        ->allow_extra_args(false)
        ->type_name("CAMERA METRES");
}

void add_finish_options(CLI::App& command, FinishOptions& finish) {
    command
        .add_option("--front",
                    finish.front,
                    "camera towards which people look, along +X, into the world; default: as in "
                    "the rig before, else the first camera")
        ->type_name("CAMERA");
    command
        .add_option("--frame-of",
                    finish.frame_of,
                    "rig.toml whose origin and axes the new rig keeps, if most of its cameras "
                    "stand where they did; default: the one that -o replaces")
        ->type_name("RIG");
    command
        .add_option("-o,--output",
                    finish.output,
                    "rig.toml to write; one that is there already is kept under another name")
        ->required();
    command
        .add_option("--report",
                    finish.report,
                    "page of figures and pictures, and the same as .json beside it; default: "
                    "calibration.html beside -o")
        ->type_name("FILE.html");
    command.add_flag("--force",
                     finish.force,
                     "write in spite of problems, and replace a rig that is still true");
}

}  // namespace atrium::calibrate
