#include "tools/play/commands.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace atrium::play {
namespace {

using Json = nlohmann::json;
using std::chrono::nanoseconds;

constexpr std::chrono::seconds kLongestShow{5};

double seconds(nanoseconds time) { return std::chrono::duration<double>(time).count(); }

std::string error_json(const std::string& what) {
    return Json{{"error", what}}.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// A number in a command; nullopt and a fault if it is missing or none.
std::optional<double> number(const Json& command, const char* key, std::string& fault) {
    const auto found = command.find(key);
    if (found == command.end() || !found->is_number()) {
        fault = fmt::format("needs the number \"{}\"", key);
        return std::nullopt;
    }
    const double value = found->get<double>();
    if (!std::isfinite(value) || std::abs(value) > 1e9) {
        fault = fmt::format("\"{}\" is out of range", key);
        return std::nullopt;
    }
    return value;
}

nanoseconds time_of(double value_s) {
    return nanoseconds(static_cast<std::int64_t>(value_s * 1e9));
}

// Does it, or says what is wrong with the command.
std::string do_command(recording::Player& player, const std::string& what, const Json& command) {
    std::string fault;
    bool shows = false;
    if (what == "play") {
        player.play();
    } else if (what == "pause") {
        player.pause();
    } else if (what == "step") {
        const double num = command.contains("num") ? number(command, "num", fault).value_or(0) : 1;
        if (fault.empty()) player.step(static_cast<int>(num));
        shows = true;
    } else if (what == "seek") {
        if (const auto time = number(command, "time_s", fault)) player.seek(time_of(*time));
        shows = true;
    } else if (what == "speed") {
        if (const auto factor = number(command, "factor", fault)) player.set_speed(*factor);
    } else if (what == "loop") {
        const auto on = command.find("on");
        if (on == command.end() || !on->is_boolean()) return "needs \"on\": true or false";
        player.set_loop(on->get<bool>());
    } else if (what == "marks") {
        const auto in = number(command, "in_s", fault);
        const auto out = number(command, "out_s", fault);
        if (in && out && *in >= *out) return "\"in_s\" must be before \"out_s\"";
        if (in && out) player.set_marks(time_of(*in), time_of(*out));
    } else if (what != "state") {
        return fmt::format(
            "'{}' is no command; there are play, pause, step, seek, speed, loop, "
            "marks, state and quit",
            what);
    }
    if (fault.empty() && shows && !player.wait_until_shown(kLongestShow))
        return "it takes longer than 5 s";
    return fault;
}

}  // namespace

std::string state_json(const recording::PlayState& state) {
    return Json{{"time_s", seconds(state.time)},
                {"duration_s", seconds(state.duration)},
                {"is_playing", state.is_playing},
                {"is_at_end", state.is_at_end},
                {"speed", state.speed},
                {"loop", state.loops},
                {"in_s", seconds(state.in)},
                {"out_s", seconds(state.out)},
                {"num_written", state.num_written},
                {"num_refused", state.num_refused},
                {"num_damaged", state.num_damaged},
                {"num_late", state.num_late}}
        .dump();
}

CommandResult obey(recording::Player& player, std::string_view line) {
    const Json command = Json::parse(line, nullptr, /*allow_exceptions=*/false);
    if (!command.is_object() || !command.contains("do") || !command["do"].is_string())
        return {
            error_json("a command is a line of JSON like {\"do\": \"seek\", \"time_s\": 12.5}")};
    const auto what = command["do"].get<std::string>();
    if (what == "quit") return {state_json(player.state()), true};
    const std::string fault = do_command(player, what, command);
    if (!fault.empty()) return {error_json(what + ": " + fault)};
    return {state_json(player.state())};
}

bool obey_key(recording::Player& player, std::string_view key) {
    const recording::PlayState state = player.state();
    constexpr std::chrono::seconds kShort{1};
    constexpr std::chrono::seconds kLong{10};
    if (key == "q" || key == "\x04") return false;
    if (key == " ") {
        if (state.is_playing)
            player.pause();
        else
            player.play();
    } else if (key == "\x1b[C") {
        player.seek(state.time + kShort);
    } else if (key == "\x1b[D") {
        player.seek(state.time - kShort);
    } else if (key == "\x1b[A") {
        player.seek(state.time + kLong);
    } else if (key == "\x1b[B") {
        player.seek(state.time - kLong);
    } else if (key == ".") {
        player.step(1);
    } else if (key == ",") {
        player.step(-1);
    } else if (key == "+" || key == "=") {
        player.set_speed(state.speed * 2.0);
    } else if (key == "-") {
        player.set_speed(state.speed / 2.0);
    } else if (key == "1") {
        player.set_speed(1.0);
    } else if (key == "l") {
        player.set_loop(!state.loops);
    } else if (key == "i") {
        player.set_marks(state.time, state.out);
    } else if (key == "o") {
        player.set_marks(state.in, state.time);
    } else if (key == "x") {
        player.set_marks(nanoseconds(0), state.duration);
    } else if (key == "0") {
        player.seek(state.in);
    }
    return true;
}

std::string state_text(const recording::PlayState& state) {
    std::string text = fmt::format("{} {} of {}  x{:g}",
                                   state.is_playing  ? "playing"
                                   : state.is_at_end ? "at the end"
                                                     : "paused",
                                   recording::position_text(state.time),
                                   recording::position_text(state.duration),
                                   state.speed);
    if (state.loops) text += "  loop";
    if (state.in.count() > 0 || state.out < state.duration)
        text += fmt::format("  in {} out {}",
                            recording::position_text(state.in),
                            recording::position_text(state.out));
    if (state.num_refused > 0) text += fmt::format("  refused {}", state.num_refused);
    if (state.num_damaged > 0) text += fmt::format("  damaged {}", state.num_damaged);
    return text;
}

}  // namespace atrium::play
