#include "tools/play/commands.hpp"

#include "tests/unit/recording/player_fixture.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace atrium::play {
namespace {

using namespace recording::testing;
using ::testing::HasSubstr;
using Json = nlohmann::json;

// A recording of 10 s with a frame each half second, which is paused.
class PlayCommands : public PlayerTest {
protected:
    void SetUp() override {
        std::vector<recording::Recorded> samples;
        for (std::uint64_t i = 0; i <= 20; ++i)
            samples.push_back(recorded(state(i), at(0.5 * static_cast<double>(i))));
        open(make(samples));
        player_->set_speed(1.0);
        start();
        shown();
    }
    Json answer(const std::string& line) {
        const CommandResult result = obey(*player_, line);
        quits_ = result.quits;
        EXPECT_EQ(result.answer.find('\n'), std::string::npos);
        return Json::parse(result.answer);
    }
    std::string error(const std::string& line) {
        const Json json = answer(line);
        return json.contains("error") ? json["error"].get<std::string>() : "";
    }
    bool quits_ = false;
};

TEST_F(PlayCommands, DoWhatTheySay) {
    EXPECT_EQ(answer(R"({"do":"seek","time_s":3.2})")["time_s"], 3.2);
    EXPECT_EQ(answer(R"({"do":"step"})")["time_s"], 3.5);
    EXPECT_EQ(answer(R"({"do":"step","num":-2})")["time_s"], 2.5);
    EXPECT_EQ(answer(R"({"do":"seek","time_s":1e8})")["time_s"], 10.0);
    EXPECT_EQ(answer(R"({"do":"speed","factor":2.5})")["speed"], 2.5);
    EXPECT_EQ(answer(R"({"do":"loop","on":true})")["loop"], true);
    const Json marked = answer(R"({"do":"marks","in_s":2,"out_s":4})");
    EXPECT_EQ(marked["in_s"], 2.0);
    EXPECT_EQ(marked["out_s"], 4.0);
    EXPECT_EQ(answer(R"({"do":"play"})")["is_playing"], true);
    EXPECT_EQ(answer(R"({"do":"pause"})")["is_playing"], false);
    EXPECT_EQ(answer(R"({"do":"state"})")["duration_s"], 10.0);
    EXPECT_FALSE(quits_);
    EXPECT_EQ(answer(R"({"do":"quit"})")["duration_s"], 10.0);
    EXPECT_TRUE(quits_);
}

TEST_F(PlayCommands, SayWhatIsWrongWithThem) {
    for (const char* line :
         {"", "seek 3", "[1]", "3", "{\"do\":3}", "{}", "{\"do\":\"seek\"", "\xff\xfe"})
        EXPECT_THAT(error(line), HasSubstr("a command is a line of JSON")) << line;
    EXPECT_THAT(error(R"({"do":"fly"})"),
                HasSubstr("'fly' is no command; there are play, pause, "));
    EXPECT_THAT(error(R"({"do":"seek"})"), HasSubstr("seek: needs the number \"time_s\""));
    EXPECT_THAT(error(R"({"do":"seek","time_s":"3"})"), HasSubstr("needs the number \"time_s\""));
    EXPECT_THAT(error(R"({"do":"seek","time_s":1e300})"), HasSubstr("\"time_s\" is out of range"));
    EXPECT_THAT(error(R"({"do":"step","num":"x"})"), HasSubstr("needs the number \"num\""));
    EXPECT_THAT(error(R"({"do":"loop"})"), HasSubstr("needs \"on\": true or false"));
    EXPECT_THAT(error(R"({"do":"marks","in_s":4,"out_s":2})"),
                HasSubstr("\"in_s\" must be before \"out_s\""));
    EXPECT_THAT(error(R"({"do":"marks","in_s":4})"), HasSubstr("needs the number \"out_s\""));
    EXPECT_THAT(error(R"({"do":"speed","factor":null})"), HasSubstr("needs the number \"factor\""));
    // Nothing of it changed anything.
    const recording::PlayState state = player_->state();
    EXPECT_EQ(state.time.count(), 0);
    EXPECT_EQ(state.speed, 1.0);
    EXPECT_FALSE(state.loops);
}

TEST_F(PlayCommands, HaveKeys) {
    const auto key = [&](std::string_view one) {
        EXPECT_TRUE(obey_key(*player_, one));
        shown();
        return player_->state();
    };
    EXPECT_EQ(key("\x1b[A").time, std::chrono::seconds(10));
    EXPECT_EQ(key("\x1b[D").time, std::chrono::seconds(9));
    EXPECT_EQ(key("\x1b[B").time, std::chrono::seconds(0));
    EXPECT_EQ(key("\x1b[C").time, std::chrono::seconds(1));
    EXPECT_EQ(key(".").time, std::chrono::milliseconds(1500));
    EXPECT_EQ(key(",").time, std::chrono::seconds(1));
    EXPECT_EQ(key("+").speed, 2.0);
    EXPECT_EQ(key("=").speed, 4.0);
    EXPECT_EQ(key("-").speed, 2.0);
    EXPECT_EQ(key("1").speed, 1.0);
    EXPECT_TRUE(key("l").loops);
    EXPECT_FALSE(key("l").loops);
    EXPECT_EQ(key("i").in, std::chrono::seconds(1));
    key("\x1b[A");
    key("\x1b[D");
    EXPECT_EQ(key("o").out, std::chrono::seconds(9));
    EXPECT_EQ(key("0").time, std::chrono::seconds(1));
    EXPECT_EQ(key("x").out, std::chrono::seconds(10));
    EXPECT_EQ(key("x").in.count(), 0);
    EXPECT_TRUE(key(" ").is_playing);
    EXPECT_FALSE(key(" ").is_playing);
    EXPECT_TRUE(obey_key(*player_, "?"));
    EXPECT_FALSE(obey_key(*player_, "q"));
    EXPECT_FALSE(obey_key(*player_, "\x04"));
}

TEST(PlayStateText, SaysWhereItIs) {
    recording::PlayState state;
    state.duration = state.out = std::chrono::seconds(605);
    state.time = std::chrono::milliseconds(65'250);
    EXPECT_EQ(state_text(state), "paused 1:05.2 of 10:05.0  x1");
    state.is_playing = true;
    state.speed = 0.5;
    state.loops = true;
    state.in = std::chrono::seconds(5);
    EXPECT_EQ(state_text(state), "playing 1:05.2 of 10:05.0  x0.5  loop  in 0:05.0 out 10:05.0");
    state = {};
    state.is_at_end = true;
    state.num_refused = 2;
    state.num_damaged = 1;
    EXPECT_EQ(state_text(state), "at the end 0:00.0 of 0:00.0  x1  refused 2  damaged 1");
}

}  // namespace
}  // namespace atrium::play
