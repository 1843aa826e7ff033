#include "viewer/receive/decoded_people.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace atrium::viewer {
namespace {

using namespace std::chrono_literals;

PersonUpdate captured_at(std::int64_t ns) {
    PersonUpdate update;
    update.capture_time.ns = ns;
    return update;
}

PersonUpdate ready_at(DecodedPeople::Clock::time_point at) {
    PersonUpdate update;
    update.ready = at;
    return update;
}

TEST(DecodedPeople, KeepTheNewestOfEachSiteAndEveryArrival) {
    DecodedPeople sut;
    EXPECT_FALSE(sut.put("a", captured_at(1)));
    EXPECT_FALSE(sut.put("b", captured_at(10)));
    const auto replaced = sut.put("a", captured_at(2));
    ASSERT_TRUE(replaced);
    EXPECT_EQ(replaced->capture_time.ns, 1);
    const auto people = sut.take_all();
    ASSERT_EQ(people.size(), 2U);
    EXPECT_EQ(people[0].update.capture_time.ns, 2);
    EXPECT_EQ(people[1].site, "b");
    EXPECT_TRUE(sut.take_all().empty());
    EXPECT_EQ(sut.take_arrivals().size(), 3U);
    EXPECT_TRUE(sut.take_arrivals().empty());
}

TEST(DecodedPeople, HoldABoundedNumberOfArrivals) {
    DecodedPeople sut;
    for (int i = 0; i < 1000; ++i)
        sut.put("a", ready_at(DecodedPeople::Clock::time_point(1ns * i)));
    const auto arrivals = sut.take_arrivals();
    EXPECT_EQ(arrivals.size(), DecodedPeople::kMostArrivals);
    EXPECT_EQ(arrivals.back().at, DecodedPeople::Clock::time_point(999ns))
        << "the newest arrival must stay";
}

TEST(DecodedPeople, ArrivalOrStopEndsTheWait) {
    DecodedPeople sut;
    const auto never = DecodedPeople::Clock::now() + 1h;
    {
        const std::jthread other([&] { sut.put("a", captured_at(1)); });
        sut.wait({}, never);
    }
    sut.wait({}, never);  // the arrival is still in the queue
    EXPECT_EQ(sut.take_arrivals().size(), 1U);
    std::stop_source source;
    const std::jthread stopper([&] { source.request_stop(); });
    sut.wait(source.get_token(), never);
    sut.wait({}, DecodedPeople::Clock::now());
}

}  // namespace
}  // namespace atrium::viewer
