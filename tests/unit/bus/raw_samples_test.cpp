#include "core/bus/raw_samples.hpp"

#include "core/bus/topics.hpp"
#include "core/bus/wire.hpp"
#include "tests/unit/bus/all_messages.hpp"
#include "tests/unit/bus/bus_support.hpp"
#include "tests/unit/bus/random_messages.hpp"

#include <gmock/gmock.h>

#include <cmath>

// Samples as bytes through a participant of this process.
namespace atrium::bus {
namespace {

using testing::own_world;
using testing::Random;
using testing::random_message;
using testing::value;

struct OwnSample {
    RawKind kind = RawKind::kSample;
    Timestamp written;
    std::vector<std::byte> cdr;
};

class RawListener {
public:
    RawListener(const RawTopic& topic, const Participant& participant)
        : reader_(value(topic.reader(participant))), waiter_(value(Waiter::create(participant))) {
        reader_->add_to(waiter_);
    }
    // False after a minute.
    bool await(std::size_t num) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
        while (samples.size() < num && std::chrono::steady_clock::now() < end) {
            waiter_.wait(std::chrono::milliseconds(100));
            reader_->take([this](const RawSample& sample) {
                samples.push_back(
                    {sample.kind, sample.written, {sample.cdr.begin(), sample.cdr.end()}});
            });
        }
        return samples.size() >= num;
    }
    int num_writers() const { return reader_->num_writers(); }

    std::vector<OwnSample> samples;

private:
    std::unique_ptr<RawReader> reader_;
    Waiter waiter_;
};

template <typename Message>
class RawLoopback : public ::testing::Test {
protected:
    Participant participant_ = value(Participant::create(own_world("raw")));
    const RawTopic& topic_ = *find_raw_topic(topic_name<Message>());
};
TYPED_TEST_SUITE(RawLoopback, testing::RawMessages);

TYPED_TEST(RawLoopback, ReadsTheBytesOfAWriter) {
    RawListener listener(this->topic_, this->participant_);
    auto writer = value(Writer<TypeParam>::create(this->participant_));
    Random random(11);
    const auto message = random_message<TypeParam>(random);
    const Timestamp before = Timestamp::now();
    ASSERT_TRUE(writer.write(message));
    ASSERT_TRUE(listener.await(1));
    EXPECT_EQ(listener.samples[0].kind, RawKind::kSample);
    EXPECT_EQ(listener.samples[0].cdr, to_cdr(message));
    EXPECT_GE(listener.samples[0].written, before);
    EXPECT_LE(listener.samples[0].written, Timestamp::now());
}

TYPED_TEST(RawLoopback, WritesBytesWithTheirTimeAndEndsInstances) {
    RawListener listener(this->topic_, this->participant_);
    auto writer = value(this->topic_.writer(this->participant_));
    Random random(12);
    const auto cdr = to_cdr(random_message<TypeParam>(random));
    const Timestamp written{Timestamp::now().ns - 12'345};
    ASSERT_TRUE(writer->write({RawKind::kSample, written, cdr}));
    ASSERT_TRUE(listener.await(1));
    EXPECT_EQ(listener.samples[0].cdr, cdr);
    EXPECT_EQ(listener.samples[0].written, written);

    const auto key = value(this->topic_.key_cdr({RawKind::kSample, written, cdr}));
    for (const RawKind kind : {RawKind::kDisposed, RawKind::kLost}) {
        listener.samples.clear();
        ASSERT_TRUE(writer->write({RawKind::kSample, Timestamp::now(), cdr}));
        ASSERT_TRUE(listener.await(1));
        listener.samples.clear();
        ASSERT_TRUE(writer->write({kind, Timestamp::now(), key}));
        ASSERT_TRUE(listener.await(1));
        EXPECT_EQ(listener.samples.back().kind, kind);
        EXPECT_EQ(listener.samples.back().cdr, key);
        // An instance that ended ends without an error.
        EXPECT_TRUE(writer->write({kind, Timestamp::now(), key}));
    }
}

TYPED_TEST(RawLoopback, RefusesBytesThatAreNoSample) {
    auto writer = value(this->topic_.writer(this->participant_));
    Random random(13);
    auto cdr = to_cdr(random_message<TypeParam>(random));
    cdr.resize(cdr.size() / 2);
    for (const RawKind kind : {RawKind::kSample, RawKind::kDisposed, RawKind::kLost}) {
        for (const std::span<const std::byte> bytes :
             {std::span<const std::byte>(cdr), std::span<const std::byte>()}) {
            const auto done = writer->write({kind, Timestamp::now(), bytes});
            if (done && kind != RawKind::kSample) continue;  // the half may have the whole key
            ASSERT_FALSE(done);
            EXPECT_EQ(done.error().kind, ErrorKind::kInvalidData);
            EXPECT_THAT(done.error().message,
                        ::testing::StartsWith(std::string(this->topic_.name()) + ": "));
        }
    }
}

TEST(RawWriter, RefusesASampleThatDoesNotPassItsChecks) {
    const auto participant = value(Participant::create(own_world("raw-checks")));
    auto writer = value(find_raw_topic("SitePlacement")->writer(participant));
    SitePlacement placement;
    placement.site = "alice";
    placement.world_from_site.translation = {std::nan(""), 0.0, 0.0};
    const auto done = writer->write({RawKind::kSample, Timestamp::now(), to_cdr(placement)});
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, ErrorKind::kInvalidData);
}

}  // namespace
}  // namespace atrium::bus
