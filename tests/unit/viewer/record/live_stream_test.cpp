#include "viewer/record/live_stream.hpp"

#include "tests/unit/viewer/record/stream_receiver.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

extern "C" {
#include <libavutil/log.h>
}

#include <chrono>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <thread>

namespace atrium::viewer {
namespace {

using testing::HasSubstr;
using Time = std::chrono::steady_clock;

const VideoFormat kFormat{.file = {}, .fps = 25.0, .width = 128, .height = 64};

// Ten bars across the picture, white or black, are the digits of `number`.
std::vector<std::uint8_t> numbered(int number) {
    std::vector<std::uint8_t> rgba;
    for (int y = 0; y < kFormat.height; ++y) {
        for (int x = 0; x < kFormat.width; ++x) {
            const bool is_white = (number >> (x * 8 / kFormat.width) & 1) != 0;
            for (int k = 0; k < 4; ++k) rgba.push_back(is_white || k == 3 ? 255 : 0);
        }
    }
    return rgba;
}

int number_in(const ReceivedPicture& picture) {
    int number = 0;
    for (int bit = 0; bit < 8; ++bit) {
        const int x = picture.width * (2 * bit + 1) / 16;
        const auto at = static_cast<std::size_t>(picture.height / 2 * picture.width + x);
        if (picture.luma[at] > 128) number |= 1 << bit;
    }
    return number;
}

template <typename Condition>
bool comes(const Condition& condition, double patience_s = 10.0) {
    const auto end = Time::now() + std::chrono::duration<double>(patience_s);
    while (!condition()) {
        if (Time::now() > end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
}

std::unique_ptr<LiveStream> stream_to(const std::string& url) {
    auto stream = LiveStream::create(url, kFormat, 0);
    EXPECT_TRUE(stream) << stream.error().message;
    return stream ? std::move(*stream) : nullptr;
}

// Writes pictures with these numbers, no faster than they are sent.
void write_numbers(LiveStream& stream, int first, int last) {
    for (int number = first; number <= last; ++number) {
        ASSERT_TRUE(stream.set(numbered(number)));
        const std::uint64_t num_before = stream.sender().num_sent() + stream.sender().num_dropped();
        ASSERT_TRUE(stream.write());
        ASSERT_TRUE(comes([&] {
            return stream.sender().num_sent() + stream.sender().num_dropped() > num_before;
        }));
    }
}

void expect_numbers(const std::vector<ReceivedPicture>& pictures, int first, int num) {
    ASSERT_EQ(pictures.size(), static_cast<std::size_t>(num));
    for (int i = 0; i < num; ++i) {
        const ReceivedPicture& picture = pictures[static_cast<std::size_t>(i)];
        EXPECT_EQ(picture.width, kFormat.width);
        EXPECT_EQ(number_in(picture), first + i);
        EXPECT_NEAR(picture.time_s, i / kFormat.fps, 1e-4) << i;
    }
}

TEST(StreamAddress, AcceptsTheUsualFormsAndHidesSecrets) {
    const auto srt = parse_stream("srt://studio:9000?passphrase=geheim1234&mode=caller");
    ASSERT_TRUE(srt);
    EXPECT_EQ(srt->shown, "srt://studio:9000");
    EXPECT_EQ(srt->url, "srt://studio:9000?mode=caller&passphrase=geheim1234");
    EXPECT_EQ(srt->format, "mpegts");
    const auto listener = parse_stream("srt://:9000?mode=listener");
    ASSERT_TRUE(listener);
    EXPECT_TRUE(listener->waits_for_receiver);
    EXPECT_EQ(listener->url, "srt://0.0.0.0:9000?mode=listener");
    const auto rtmp = parse_stream("rtmp://live.example.org/app/secret-key");
    ASSERT_TRUE(rtmp);
    EXPECT_EQ(rtmp->shown, "rtmp://live.example.org/app");
    EXPECT_EQ(rtmp->url, "rtmp://live.example.org/app/secret-key");
    EXPECT_EQ(rtmp->format, "flv");
    EXPECT_EQ(parse_stream("tcp://[::1]:7000?mode=listener")->url, "tcp://[::1]:7000?listen=1");
}

TEST(StreamAddress, NamesTheFaultWithoutTheOptions) {
    for (const auto& [url, fault] : std::vector<std::pair<std::string, std::string>>{
             {"obs", "has no scheme"},
             {"http://host:1", "unknown scheme 'http'"},
             {"srt://host", "has no port"},
             {"srt://host:0", "'0' is no port"},
             {"srt://host:99999", "is no port"},
             {"srt://:9000", "has no host"},
             {"srt://h:1?mode=server", "mode is 'server'"},
             {"udp://h:1?mode=listener", "only srt and tcp"},
             {"rtmp://host", "has no application"}}) {
        const auto target = parse_stream(url + (url.find('?') == std::string::npos ? "?" : "&") +
                                         "passphrase=geheim");
        ASSERT_FALSE(target) << url;
        EXPECT_EQ(target.error().kind, ErrorKind::kConfiguration);
        EXPECT_THAT(target.error().message, HasSubstr(fault));
        EXPECT_THAT(target.error().message, HasSubstr("video.stream"));
        EXPECT_THAT(target.error().message, testing::Not(HasSubstr("geheim")));
    }
}

// OpenCV's videos set libav's level again, and its messages hold the address with all options.
TEST(LiveStream, KeepsLibavSilent) {
    const auto stream = stream_to("udp://127.0.0.1:" + std::to_string(free_port()));
    ASSERT_TRUE(stream);
    av_log_set_level(AV_LOG_ERROR);
    testing::internal::CaptureStderr();
    av_log(nullptr, AV_LOG_ERROR, "srt://host:1?passphrase=geheim");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

class LiveStreamOver : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(LiveStreamOver, ReceiverGetsEveryPictureAtItsTime) {
    const std::string port = std::to_string(free_port());
    const auto url = [&](std::string text) { return text.replace(text.find("PORT"), 4, port); };
    StreamReceiver receiver(url(GetParam().second));
    const auto stream = stream_to(url(GetParam().first));
    ASSERT_TRUE(comes([&] { return stream->sender().is_connected(); }))
        << stream->sender().problem();
    write_numbers(*stream, 1, 60);
    EXPECT_EQ(stream->sender().num_dropped(), 0u);
    // the last ones wait in the receiver for what follows them
    EXPECT_TRUE(comes([&] { return receiver.num_pictures() >= 57; })) << receiver.num_pictures();
    ASSERT_TRUE(stream->finish());
    const auto pictures = receiver.take();
    ASSERT_GE(pictures.size(), 57u);
    expect_numbers(pictures, 1, static_cast<int>(pictures.size()));
}

INSTANTIATE_TEST_SUITE_P(
    Protocols,
    LiveStreamOver,
    testing::Values(
        std::pair("tcp://127.0.0.1:PORT?mode=listener", "tcp://127.0.0.1:PORT"),
        std::pair("tcp://127.0.0.1:PORT", "tcp://127.0.0.1:PORT?listen=1"),
        std::pair("srt://127.0.0.1:PORT?mode=caller", "srt://127.0.0.1:PORT?mode=listener"),
        std::pair("srt://127.0.0.1:PORT?mode=listener", "srt://127.0.0.1:PORT?mode=caller"),
        std::pair("rtmp://127.0.0.1:PORT/live/key", "rtmp://127.0.0.1:PORT/live/key")));

TEST(LiveStream, ConnectsAgainWithAKeyPicture) {
    const std::string port = std::to_string(free_port());
    const auto stream = stream_to("tcp://127.0.0.1:" + port + "?mode=listener");
    {
        StreamReceiver first("tcp://127.0.0.1:" + port);
        ASSERT_TRUE(comes([&] { return stream->sender().is_connected(); }));
        write_numbers(*stream, 1, 20);
        ASSERT_TRUE(comes([&] { return first.num_pictures() >= 17; }));
    }
    // the end of a connection shows when something is sent
    ASSERT_TRUE(comes([&] {
        EXPECT_TRUE(stream->write());
        return !stream->sender().is_connected();
    }));
    EXPECT_FALSE(stream->sender().problem().empty());
    StreamReceiver second("tcp://127.0.0.1:" + port);
    ASSERT_TRUE(comes([&] { return stream->sender().num_connections() == 2; }));
    ASSERT_TRUE(comes([&] { return stream->sender().is_connected(); }));
    EXPECT_EQ(stream->sender().problem(), "");
    write_numbers(*stream, 101, 120);
    ASSERT_TRUE(comes([&] { return second.num_pictures() >= 17; }));
    const auto pictures = second.take();
    expect_numbers(pictures, 101, static_cast<int>(pictures.size()));
}

TEST(LiveStream, NobodyThereCostsNothingAndIsSaid) {
    const auto stream = stream_to("tcp://127.0.0.1:" + std::to_string(free_port()));
    ASSERT_TRUE(comes([&] { return !stream->sender().problem().empty(); }));
    EXPECT_THAT(stream->sender().problem(), HasSubstr("Connection refused"));
    ASSERT_TRUE(stream->set(numbered(1)));
    const auto begin = Time::now();
    for (int i = 0; i < 1000; ++i) ASSERT_TRUE(stream->write());
    EXPECT_LT(Time::now() - begin, std::chrono::milliseconds(500));
    EXPECT_EQ(stream->sender().num_sent(), 0u);
}

TEST(LiveStream, EndsAtOnceWhileItWaits) {
    for (const char* url :
         {"srt://127.0.0.1:9?mode=caller", "srt://127.0.0.1:PORT?mode=listener"}) {
        std::string address = url;
        const std::size_t at = address.find("PORT");
        if (at != std::string::npos) address.replace(at, 4, std::to_string(free_port()));
        const auto stream = stream_to(address);
        const auto begin = Time::now();
        ASSERT_TRUE(stream->finish());
        EXPECT_LT(Time::now() - begin, std::chrono::seconds(2)) << address;
    }
}

// A receiver that accepts and never reads.
TEST(LiveStream, AReceiverThatStallsCostsPicturesNotTime) {
    const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int port = free_port();
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    ASSERT_EQ(::bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    ASSERT_EQ(::listen(listener, 1), 0);
    // pictures that fill the buffers between
    const VideoFormat large{.file = {}, .fps = 25.0, .width = 512, .height = 256};
    const auto created =
        LiveStream::create("tcp://127.0.0.1:" + std::to_string(port), large, 200'000);
    ASSERT_TRUE(created) << created.error().message;
    const auto& stream = *created;
    ASSERT_TRUE(comes([&] { return stream->sender().is_connected(); }));
    std::mt19937 random(1);
    std::vector<std::uint8_t> noise(std::size_t{4} * 512 * 256);
    auto slowest = Time::duration::zero();
    for (int i = 0; i < 300 && stream->sender().num_dropped() <= 20; ++i) {
        for (std::size_t at = 0; at < noise.size(); at += 4) {
            const auto value = static_cast<std::uint32_t>(random());
            std::memcpy(&noise[at], &value, 4);
        }
        ASSERT_TRUE(stream->set(noise));
        const auto begin = Time::now();
        ASSERT_TRUE(stream->write());
        slowest = std::max(slowest, Time::now() - begin);
    }
    EXPECT_GT(stream->sender().num_dropped(), 20u);
    EXPECT_LT(slowest, std::chrono::milliseconds(500));
    ::close(listener);
}

}  // namespace
}  // namespace atrium::viewer
