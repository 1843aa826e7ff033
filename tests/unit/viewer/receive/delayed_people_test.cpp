#include "viewer/receive/delayed_people.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

PersonUpdate person_of(std::int64_t capture_ns) {
    PersonUpdate update;
    update.model.emplace();
    update.capture_time = {capture_ns};
    return update;
}

class DelayedPeopleTest : public testing::Test {
protected:
    void add(const std::string& site, PersonUpdate update) {
        people_.add(site, std::move(update), note_);
    }
    // The capture times of the due people, or -1 for a person who left.
    std::map<std::string, std::int64_t> take(std::int64_t instant_ns) {
        std::map<std::string, std::int64_t> shown;
        for (const auto& [site, update] : people_.take({instant_ns}, note_))
            shown[site] = update.model ? update.capture_time.ns : -1;
        return shown;
    }

    DelayedPeople people_;
    std::vector<std::int64_t> skipped_;
    std::function<void(PersonUpdate)> note_ = [this](PersonUpdate update) {
        skipped_.push_back(update.capture_time.ns);
    };
};

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

TEST_F(DelayedPeopleTest, AreTheNewestDueOnesOfEachSite) {
    for (const std::int64_t time : {10, 20, 30}) add("alice", person_of(time));
    add("bob", person_of(25));
    EXPECT_THAT(take(5), IsEmpty());
    EXPECT_THAT(take(20), ElementsAre(Pair("alice", 20)));
    EXPECT_THAT(skipped_, ElementsAre(10));
    EXPECT_THAT(take(29), ElementsAre(Pair("bob", 25)));
    EXPECT_THAT(take(29), IsEmpty()) << "a shown person must not come again";
    EXPECT_THAT(take(100), ElementsAre(Pair("alice", 30)));
}

TEST_F(DelayedPeopleTest, DisappearAtOnce) {
    add("alice", person_of(10));
    add("alice", {});
    EXPECT_THAT(take(10), ElementsAre(Pair("alice", -1)));
    EXPECT_THAT(skipped_, ElementsAre(10));
}

// Two viewers that ask at different times show the same for the same instant.
TEST_F(DelayedPeopleTest, DoNotDependOnTheTimesOfCalls) {
    DelayedPeople other;
    std::int64_t shown = 0, shown_by_other = 0;
    for (std::int64_t now = 0; now < 1000; ++now) {
        if (now % 33 == 0) {
            add("alice", person_of(now));
            other.add("alice", person_of(now), note_);
        }
        const std::int64_t instant = (now - 100) / 16 * 16;
        for (const auto& [site, time] : take(instant)) shown = time;
        if (now % 16 != 15) continue;
        for (const auto& [site, update] : other.take({instant}, note_))
            shown_by_other = update.capture_time.ns;
        EXPECT_EQ(shown, shown_by_other);
    }
    EXPECT_GT(shown, 800);
}

TEST_F(DelayedPeopleTest, DoNotPileUpWithoutCalls) {
    for (std::int64_t time = 0; time < 100; ++time) add("alice", person_of(time));
    EXPECT_EQ(skipped_.size(), 84U);
    EXPECT_EQ(skipped_.back(), 83);
}

}  // namespace
}  // namespace atrium::viewer
