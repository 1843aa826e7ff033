#include "site_node/record_orders.hpp"

#include "tests/unit/record/recorder_fixture.hpp"
#include "tools/record/room_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <optional>
#include <thread>

namespace atrium::site_node {
namespace {

using testing::HasSubstr;

// A site's recorder that takes orders, fed by cameras, and a program that orders.
class RecordOrdersOverTheBus : public record::test::RecorderOnDisk {
protected:
    void SetUp() override {
        order_.bus.world = "record_orders_" + std::to_string(getpid());
        order_.site = "lab";
        order_.folder = "monday";
        recorder_ = make_recorder();
        auto participant = bus::Participant::create(order_.bus);
        ASSERT_TRUE(participant) << participant.error().message;
        participant_.emplace(std::move(*participant));
        auto orders = RecordOrders::create(*participant_, "lab", folder_ / "rooms", *recorder_);
        ASSERT_TRUE(orders) << orders.error().message;
        orders_ = std::move(*orders);
        taking_ = std::jthread([this](std::stop_token stop) { orders_->run(std::move(stop)); });
        cameras_ = std::jthread([this](const std::stop_token& stop) {
            for (int i = 0; !stop.stop_requested(); ++i) {
                add(*recorder_, i, i + 1);
                std::this_thread::sleep_for(std::chrono::milliseconds(2));  // the cameras' pace
            }
        });
    }
    // Ends the room's recording as Ctrl-C does, once pictures are written.
    Expected<void> record_some() {
        std::stop_source stop;
        const std::jthread watching([&] {
            while (recorder_->counters().empty() || recorder_->counters()[0].num_written < 5)
                std::this_thread::yield();
            stop.request_stop();
        });
        return record_tool::record_room(order_, stop.get_token());
    }

    record_tool::RoomOrderConfig order_;
    std::unique_ptr<record::RawRecorder> recorder_;
    std::optional<bus::Participant> participant_;
    std::unique_ptr<RecordOrders> orders_;
    std::jthread taking_;
    std::jthread cameras_;
};

TEST_F(RecordOrdersOverTheBus, RecordUntilTheStop) {
    const auto done = record_some();
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_FALSE(recorder_->is_recording());
    const auto source = open(folder_ / "rooms" / "monday");
    ASSERT_NE(source, nullptr);
    EXPECT_GE(source->num_frames(), 5u);
}

TEST_F(RecordOrdersOverTheBus, RefuseAFolderThatIsTaken) {
    ASSERT_TRUE(record_some());
    const auto again = record_tool::record_room(order_, {});
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(again.error().message, HasSubstr("holds a recording already"));
}

TEST_F(RecordOrdersOverTheBus, RefuseASecondRecordingAndNamesThatLeadOut) {
    ASSERT_TRUE(recorder_->start(folder_ / "first"));
    const auto second = record_tool::record_room(order_, {});
    ASSERT_FALSE(second);
    EXPECT_THAT(second.error().message, HasSubstr("recording already"));
    ASSERT_TRUE(recorder_->stop());
    order_.folder = "..";
    const auto outside = record_tool::record_room(order_, {});
    ASSERT_FALSE(outside);
    EXPECT_THAT(outside.error().message, HasSubstr("names no folder"));
}

TEST_F(RecordOrdersOverTheBus, TellTheFaultThatEndsARecording) {
    std::jthread filling([this] {
        while (recorder_->counters().empty() || recorder_->counters()[0].num_written < 5)
            std::this_thread::yield();
        set_free_bytes(0);
    });
    const auto done = record_tool::record_room(order_, {});
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, ErrorKind::kInternal);
    EXPECT_THAT(done.error().message, HasSubstr("the recording ended"));
}

TEST_F(RecordOrdersOverTheBus, AreNotForOtherSites) {
    order_.site = "hall";
    const auto done = record_tool::record_room(order_, {});
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(done.error().message, HasSubstr("takes no orders"));
    EXPECT_FALSE(recorder_->is_recording());
}

}  // namespace
}  // namespace atrium::site_node
