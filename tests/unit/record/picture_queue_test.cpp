#include "site_node/record/picture_queue.hpp"

#include "tests/unit/record/raw_pictures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::record {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

class QueueOfPictures : public test::OwnFolder {
protected:
    PictureQueue::Session session_ = [this] {
        auto session = RecordingSession::create(folder_ / "recording",
                                                {"", test::make_rig(2, 16, 16), {}, ""},
                                                capture::RawCodec::kRaw,
                                                system_calls());
        return PictureQueue::Session(std::move(*session));
    }();

    static bool add(PictureQueue& queue,
                    std::uint64_t number,
                    const PictureQueue::Session& session,
                    std::size_t num_bytes = 100) {
        auto memory = queue.reserve(num_bytes);
        if (!memory) return false;
        memory->assign(num_bytes, 0);
        queue.add({number % 2,
                   number,
                   Timestamp{} + static_cast<int>(number) * 1s,
                   {},
                   std::move(*memory)},
                  session);
        return true;
    }
    static std::vector<std::uint64_t> take_all(PictureQueue& queue, std::size_t writer) {
        std::stop_source stop;
        stop.request_stop();  // a queue with pictures gives them all the same
        std::vector<std::uint64_t> numbers;
        while (auto item = queue.take(writer, stop.get_token())) {
            numbers.push_back(item->picture.number);
            queue.done(std::move(*item));
        }
        return numbers;
    }
};

TEST_F(QueueOfPictures, KeepsTheOrderOfEachCamera) {
    PictureQueue queue({.num_writers = 2, .queue_bytes = 1000});
    for (std::uint64_t i = 0; i < 6; ++i) ASSERT_TRUE(add(queue, i, session_));
    EXPECT_EQ(queue.num_bytes_waiting(), 600u);
    EXPECT_THAT(take_all(queue, 0), ElementsAre(0, 2, 4));
    EXPECT_THAT(take_all(queue, 1), ElementsAre(1, 3, 5));
    EXPECT_EQ(queue.num_bytes_waiting(), 0u);
}

TEST_F(QueueOfPictures, RefusesTheNewestPictureWhenItIsFull) {
    PictureQueue queue({.num_writers = 1, .queue_bytes = 250});
    EXPECT_TRUE(add(queue, 0, session_));
    EXPECT_TRUE(add(queue, 1, session_));
    EXPECT_FALSE(add(queue, 2, session_));
    EXPECT_THAT(take_all(queue, 0), ElementsAre(0, 1));
    EXPECT_TRUE(add(queue, 3, session_));
}

TEST_F(QueueOfPictures, TakesOnePictureHoweverSmallItIs) {
    PictureQueue queue({.num_writers = 1, .queue_bytes = 10});
    EXPECT_TRUE(add(queue, 0, session_));
    EXPECT_FALSE(add(queue, 1, session_));
}

TEST_F(QueueOfPictures, KeepsTheNewestPicturesInTheRing) {
    PictureQueue by_time(
        {.num_writers = 1, .queue_bytes = 100, .ring_bytes = 1'000'000, .ring_time = 3s});
    for (std::uint64_t i = 0; i < 20; ++i) ASSERT_TRUE(add(by_time, i, nullptr));
    const auto given = by_time.give_ring_to(session_);
    ASSERT_TRUE(given);
    EXPECT_EQ(given->first, 16u);
    EXPECT_THAT(given->cameras, ElementsAre(0, 1, 0, 1));
    EXPECT_THAT(take_all(by_time, 0), ElementsAre(0, 1, 2, 3));

    PictureQueue by_memory(
        {.num_writers = 1, .queue_bytes = 100, .ring_bytes = 250, .ring_time = 100s});
    for (std::uint64_t i = 0; i < 20; ++i) ASSERT_TRUE(add(by_memory, i, nullptr));
    EXPECT_EQ(by_memory.give_ring_to(session_)->first, 18u);
    EXPECT_TRUE(add(by_memory, 2, session_));  // the ring does not fill the queue
    EXPECT_THAT(take_all(by_memory, 0), ElementsAre(0, 1, 2));
    EXPECT_FALSE(by_memory.give_ring_to(session_));
}

TEST_F(QueueOfPictures, ReusesMemory) {
    PictureQueue queue({.num_writers = 1, .queue_bytes = 1000});
    ASSERT_TRUE(add(queue, 0, session_));
    take_all(queue, 0);
    const auto memory = queue.reserve(100);
    ASSERT_TRUE(memory);
    EXPECT_GE(memory->capacity(), 100u);
}

}  // namespace
}  // namespace atrium::record
