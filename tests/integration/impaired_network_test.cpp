#include "tests/support/network/impaired_network.hpp"

#include "tests/support/skips.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>
#include <thread>
#include <vector>

// Packets through the test network, from socket to socket. unit/support tests the lines without
// real time. These tests check the relay and the kernel.
namespace atrium::test {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr std::uint16_t kPort = 7000;
constexpr std::size_t kHeaders = 28;  // IP and UDP

nanoseconds wall_clock() { return std::chrono::system_clock::now().time_since_epoch(); }

struct Probe {
    std::int64_t number = 0;
    nanoseconds sent{0};
};
struct Arrival {
    std::int64_t number = 0;
    nanoseconds arrived{0};  // when the receiver's kernel got it
    nanoseconds delay{0};
};

class ImpairedNetworkTest : public testing::Test {
protected:
    static constexpr int kNumHosts = 3;

    void SetUp() override {
        auto network = ImpairedNetwork::create(kNumHosts, 5);
        if (!network) GTEST_SKIP() << atrium::test::skip::kNoNetwork << network.error().message;
        network_ = std::move(*network);
        for (int i = 0; i < kNumHosts; ++i) {
            auto socket = network_->udp_socket(i, kPort);
            ASSERT_TRUE(socket) << socket.error().message;
            const int size = 32 << 20;
            setsockopt((*socket)->get(), SOL_SOCKET, SO_RCVBUF, &size, sizeof(size));
            sockets_.push_back(std::move(*socket));
        }
    }

    void send(int from, const std::string& to, std::int64_t number, std::size_t num_bytes = 100) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(kPort);
        ASSERT_EQ(inet_pton(AF_INET, to.c_str(), &address.sin_addr), 1);
        std::vector<char> bytes(num_bytes - kHeaders);
        const Probe probe{number, wall_clock()};
        std::memcpy(bytes.data(), &probe, sizeof(probe));
        ASSERT_EQ(sendto(sockets_[static_cast<std::size_t>(from)]->get(),
                         bytes.data(),
                         bytes.size(),
                         0,
                         reinterpret_cast<const sockaddr*>(&address),
                         sizeof(address)),
                  static_cast<ssize_t>(bytes.size()));
    }
    void send(int from, int to, std::int64_t number, std::size_t num_bytes = 100) {
        send(from, network_->address(to), number, num_bytes);
    }

    // Receives all packets until none is on its way.
    std::vector<Arrival> arrivals(int host) {
        const auto end = std::chrono::steady_clock::now() + 20s;
        while (!is_still() && std::chrono::steady_clock::now() < end)
            std::this_thread::sleep_for(1ms);
        EXPECT_TRUE(is_still());
        std::vector<Arrival> result;
        while (auto arrival = receive(host)) result.push_back(*arrival);
        return result;
    }

    // Waits until the relay has handled each sent packet and none is on its way.
    bool is_still() {
        std::uint64_t num_in_flight = 0;
        for (int i = 0; i < kNumHosts; ++i) {
            num_in_flight += network_->counters(i, Way::kUp).in_flight() +
                             network_->counters(i, Way::kDown).in_flight();
        }
        return num_in_flight == 0 && num_entered() >= num_expected_;
    }
    std::uint64_t num_entered() {
        std::uint64_t sum = 0;
        for (int i = 0; i < kNumHosts; ++i) sum += network_->counters(i, Way::kUp).entered;
        return sum;
    }

    std::optional<Arrival> receive(int host) {
        Probe probe;
        iovec part{&probe, sizeof(probe)};
        alignas(cmsghdr) std::array<char, 256> control{};
        msghdr message{};
        message.msg_iov = &part;
        message.msg_iovlen = 1;
        message.msg_control = control.data();
        message.msg_controllen = control.size();
        const int socket = sockets_[static_cast<std::size_t>(host)]->get();
        if (recvmsg(socket, &message, MSG_DONTWAIT) < 0) return {};
        timespec stamp{};
        for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
            if (c->cmsg_type == SO_TIMESTAMPNS) std::memcpy(&stamp, CMSG_DATA(c), sizeof(stamp));
        }
        const nanoseconds arrived = 1s * stamp.tv_sec + 1ns * stamp.tv_nsec;
        return Arrival{probe.number, arrived, arrived - probe.sent};
    }

    std::unique_ptr<ImpairedNetwork> network_;
    std::vector<std::unique_ptr<Descriptor>> sockets_;
    std::uint64_t num_expected_ = 0;
};

// Delay of the packet at this fraction of all, sorted from the shortest.
double delay_ms_of(std::vector<Arrival> arrivals, double share) {
    const auto at =
        arrivals.begin() + std::lround(share * static_cast<double>(arrivals.size() - 1));
    std::nth_element(arrivals.begin(), at, arrivals.end(), [](const Arrival& a, const Arrival& b) {
        return a.delay < b.delay;
    });
    return std::chrono::duration<double, std::milli>(at->delay).count();
}

TEST_F(ImpairedNetworkTest, DelaysEachDirectionOfEachHostSeparately) {
    network_->set(0, Way::kUp, {.delay = 30ms});
    network_->set(1, Way::kUp, {.delay = 10ms});
    network_->set(1, Way::kDown, {.delay = 5ms});
    for (int i = 0; i < 100; ++i) {
        send(0, 1, i);
        send(1, 0, i);
        send(0, 2, i);
        num_expected_ += 3;
        std::this_thread::sleep_for(1ms);
    }
    const std::vector<Arrival> at_1 = arrivals(1);
    const std::vector<Arrival> at_0 = arrivals(0);
    const std::vector<Arrival> at_2 = arrivals(2);
    ASSERT_EQ(at_1.size(), 100u);
    ASSERT_EQ(at_0.size(), 100u);
    ASSERT_EQ(at_2.size(), 100u);
    // the shortest delay: a busy machine may keep packets, but none arrives early
    for (const auto& [seen, delay_ms] :
         {std::pair(&at_1, 35.0), std::pair(&at_0, 10.0), std::pair(&at_2, 30.0)}) {
        EXPECT_GE(delay_ms_of(*seen, 0.0), delay_ms);
        EXPECT_LT(delay_ms_of(*seen, 0.0), delay_ms + 1.0);
        for (std::size_t i = 0; i < seen->size(); ++i)
            EXPECT_EQ((*seen)[i].number, static_cast<std::int64_t>(i));
    }
}

TEST_F(ImpairedNetworkTest, LosesTheSamePacketsInEachRun) {
    constexpr int kNum = 2000;
    std::array<std::vector<std::int64_t>, 2> seen;
    for (auto& numbers : seen) {
        num_expected_ = 0;
        sockets_.clear();
        SetUp();
        network_->set(0, Way::kUp, {.delay = 1ms, .loss = 0.05});
        for (int i = 0; i < kNum; ++i) send(0, 1, i);
        num_expected_ = kNum;
        for (const Arrival& arrival : arrivals(1)) numbers.push_back(arrival.number);
        const LineCounters counters = network_->counters(0, Way::kUp);
        EXPECT_EQ(counters.entered, static_cast<std::uint64_t>(kNum));
        EXPECT_EQ(counters.entered, numbers.size() + counters.lost);
        EXPECT_NEAR(static_cast<double>(counters.lost), 100, 4 * std::sqrt(kNum * 0.05 * 0.95));
    }
    EXPECT_EQ(seen[0], seen[1]);
}

TEST_F(ImpairedNetworkTest, KeepsARateLimitAndDropsTheRestInTheQueue) {
    network_->set(0, Way::kUp, {.rate_bit_per_s = 10e6, .queue = 50ms});
    constexpr std::size_t kBytes = 1250;  // 1 ms each
    constexpr std::uint64_t kNumCarried = 500;
    std::int64_t number = 0;
    LineCounters counters;
    do {  // 40 Mbit/s, as long as a busy machine needs
        for (int i = 0; i < 4; ++i) send(0, 1, number++, kBytes);
        std::this_thread::sleep_for(1ms);
        counters = network_->counters(0, Way::kUp);
    } while (counters.entered - counters.dropped_by_queue < kNumCarried);
    num_expected_ = static_cast<std::uint64_t>(number);
    const std::vector<Arrival> seen = arrivals(1);
    counters = network_->counters(0, Way::kUp);
    EXPECT_GT(counters.dropped_by_queue, 100u);
    EXPECT_EQ(counters.entered, seen.size() + counters.dropped_by_queue);
    EXPECT_LE(counters.longest_queue, 50ms);
    // While packets queue, they leave a millisecond apart. A busy machine can stop this process
    // until the queue runs dry. The median over stretches of 50 packets ignores that.
    constexpr std::size_t kStretch = 50;
    ASSERT_GE(seen.size(), kNumCarried);
    std::vector<double> between_ms;
    for (std::size_t i = kStretch; i < seen.size(); i += kStretch)
        between_ms.push_back(
            std::chrono::duration<double, std::milli>(seen[i].arrived - seen[i - kStretch].arrived)
                .count() /
            static_cast<double>(kStretch));
    const auto middle = between_ms.begin() + static_cast<std::ptrdiff_t>(between_ms.size() / 2);
    std::nth_element(between_ms.begin(), middle, between_ms.end());
    EXPECT_NEAR(*middle, 1.0, 0.05);
}

TEST_F(ImpairedNetworkTest, CutHostReceivesNothingUntilRestored) {
    send(0, 1, 1);
    num_expected_ = 1;
    EXPECT_EQ(arrivals(1).size(), 1u);
    network_->cut(1);
    send(0, 1, 2);
    send(1, 0, 3);
    send(0, 2, 4);
    num_expected_ = 4;
    EXPECT_EQ(arrivals(1).size(), 0u);
    EXPECT_EQ(arrivals(0).size(), 0u);
    EXPECT_EQ(arrivals(2).size(), 1u);
    EXPECT_EQ(network_->counters(1, Way::kDown).dropped_by_cut, 1u);
    EXPECT_EQ(network_->counters(1, Way::kUp).dropped_by_cut, 1u);
    network_->restore(1);
    send(0, 1, 5);
    num_expected_ = 5;
    const std::vector<Arrival> seen = arrivals(1);
    ASSERT_EQ(seen.size(), 1u);
    EXPECT_EQ(seen[0].number, 5);
}

TEST_F(ImpairedNetworkTest, MulticastReachesOnlyMembers) {
    const std::string group = "239.255.0.1";
    for (const int member : {1, 2}) {
        ip_mreqn request{};
        inet_pton(AF_INET, group.c_str(), &request.imr_multiaddr);
        inet_pton(AF_INET, network_->address(member).c_str(), &request.imr_address);
        ASSERT_EQ(setsockopt(sockets_[static_cast<std::size_t>(member)]->get(),
                             IPPROTO_IP,
                             IP_ADD_MEMBERSHIP,
                             &request,
                             sizeof(request)),
                  0);
    }
    send(0, group, 1);
    num_expected_ = 1;
    while (!is_still()) std::this_thread::sleep_for(1ms);
    EXPECT_EQ(network_->counters(0, Way::kDown).entered, 0u);
    EXPECT_EQ(network_->counters(1, Way::kDown).left, 1u);
    EXPECT_EQ(network_->counters(2, Way::kDown).left, 1u);
}

TEST_F(ImpairedNetworkTest, CarriesHighRatesWithLittleProcessorTime) {
    constexpr std::size_t kBytes = 1400;
    constexpr int kNum = 18'000;  // 200 Mbit in a second
    network_->set(0, Way::kUp, {.delay = 10ms, .loss = 0.01, .rate_bit_per_s = 1e9});
    const auto start = std::chrono::steady_clock::now();
    std::vector<Arrival> seen;
    for (int i = 0; i < kNum; ++i) {
        send(0, 1, i, kBytes);
        if (i % 18 != 17) continue;
        std::this_thread::sleep_until(start + (i + 1) * nanoseconds(1s) / kNum);
        while (auto arrival = receive(1)) seen.push_back(*arrival);  // before its buffer is full
    }
    num_expected_ = kNum;
    for (const Arrival& arrival : arrivals(1)) seen.push_back(arrival);
    const auto worked = network_->relay().processor_time();
    const LineCounters counters = network_->counters(0, Way::kUp);
    EXPECT_EQ(counters.entered, static_cast<std::uint64_t>(kNum));
    EXPECT_EQ(network_->counters(1, Way::kDown).left + counters.lost, counters.entered);
    EXPECT_LT(worked, 1s);
    EXPECT_LT(delay_ms_of(seen, 0.0), 11.0);
    std::printf("200 Mbit/s: median delay %.3f ms instead of 10, %.1f %% of a core\n",
                delay_ms_of(seen, 0.5),
                std::chrono::duration<double>(worked).count() * 100);
}

TEST_F(ImpairedNetworkTest, RunsStopsAndEndsProgramsInTheirHost) {
    auto shell = network_->start(
        1, {"/bin/sh", "-c", "cat /proc/net/fib_trie; echo ready; while :; do sleep 0.01; done"});
    ASSERT_TRUE(shell) << shell.error().message;
    ASSERT_TRUE((*shell)->wait_for_output("ready", 20s)) << (*shell)->output();
    EXPECT_NE((*shell)->output().find(network_->address(1)), std::string::npos);
    EXPECT_EQ((*shell)->output().find(network_->address(0)), std::string::npos);
    (*shell)->signal(SIGSTOP);
    EXPECT_FALSE((*shell)->wait(50ms));
    (*shell)->signal(SIGCONT);
    (*shell)->signal(SIGTERM);
    EXPECT_EQ((*shell)->wait(20s), 128 + SIGTERM);

    auto ends = network_->start(0, {"/bin/sh", "-c", "echo some; echo other >&2; exit 7"});
    ASSERT_TRUE(ends);
    EXPECT_EQ((*ends)->wait(20s), 7);
    EXPECT_EQ((*ends)->output(), "some\nother\n");
    EXPECT_FALSE(network_->start(0, {"/no/such/program"}));
}

TEST_F(ImpairedNetworkTest, LeavesNothingWhenTheTestIsKilled) {
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe(pipe.data()), 0);
    const pid_t test = fork();
    if (test == 0) {  // the child stands for a test, without the threads of this one
        auto shell = network_->start(1, {"/bin/sh", "-c", "echo ready; read never < /dev/zero"});
        const pid_t id = shell && (*shell)->wait_for_output("ready", 20s) ? (*shell)->id() : 0;
        [[maybe_unused]] const auto n = write(pipe[1], &id, sizeof(id));
        raise(SIGKILL);
    }
    close(pipe[1]);
    pid_t program = 0;
    ASSERT_EQ(read(pipe[0], &program, sizeof(program)), static_cast<ssize_t>(sizeof(program)));
    close(pipe[0]);
    waitpid(test, nullptr, 0);
    ASSERT_GT(program, 0);
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (kill(program, 0) == 0 && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(1ms);
    EXPECT_NE(kill(program, 0), 0);
}

}  // namespace
}  // namespace atrium::test
