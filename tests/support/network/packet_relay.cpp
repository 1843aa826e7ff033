#include "tests/support/network/packet_relay.hpp"

#include <netinet/in.h>
#include <pthread.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <ctime>
#include <stop_token>
#include <utility>

namespace atrium::test {
namespace {

constexpr int kReadsAtOnce = 64;  // then check for due packets
constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t now() {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * kSecond_ns + time.tv_nsec;
}

bool is_carried(const std::uint8_t* bytes, std::size_t num_bytes) {
    constexpr std::size_t kHeader = 20;
    constexpr std::size_t kProtocolAt = 9;
    return num_bytes >= kHeader && bytes[0] >> 4 == 4 && bytes[kProtocolAt] != IPPROTO_IGMP;
}

std::uint32_t destination(const std::uint8_t* bytes) {
    return (std::uint32_t{bytes[16]} << 24) | (std::uint32_t{bytes[17]} << 16) |
           (std::uint32_t{bytes[18]} << 8) | bytes[19];
}

void watch(int epoll, int descriptor, int index) {
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.fd = index;
    [[maybe_unused]] const int result = epoll_ctl(epoll, EPOLL_CTL_ADD, descriptor, &event);
    assert(result == 0);
}

}  // namespace

bool PacketRelay::is_later(const Event& a, const Event& b) {
    return std::pair(a.due_ns, a.order) > std::pair(b.due_ns, b.order);
}

PacketRelay::PacketRelay(std::vector<Port> ports, std::uint64_t seed)
    : ports_(std::move(ports)),
      epoll_(epoll_create1(EPOLL_CLOEXEC)),
      timer_(timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK)),
      stop_event_(eventfd(0, EFD_CLOEXEC)) {
    constexpr std::uint64_t kMostLines = 1024;
    for (std::uint64_t line = 0; line < 2 * ports_.size(); ++line)
        lines_.emplace_back(kMostLines * seed + line);
    for (std::size_t i = 0; i < ports_.size(); ++i) {
        watch(epoll_.get(), ports_[i].tun->get(), static_cast<int>(i));
    }
    watch(epoll_.get(), timer_.get(), static_cast<int>(ports_.size()));
    watch(epoll_.get(), stop_event_.get(), static_cast<int>(ports_.size()) + 1);
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

PacketRelay::~PacketRelay() {
    thread_.request_stop();
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(stop_event_.get(), &one, sizeof(one));
    thread_.join();
}

void PacketRelay::set(int port, Way way, const Impairment& impairment) {
    const std::lock_guard lock(mutex_);
    lines_[static_cast<std::size_t>(line_of(port, way))].set(impairment);
}

void PacketRelay::cut(int port, Way way) {
    const std::lock_guard lock(mutex_);
    lines_[static_cast<std::size_t>(line_of(port, way))].cut();
}

void PacketRelay::restore(int port, Way way) {
    const std::lock_guard lock(mutex_);
    lines_[static_cast<std::size_t>(line_of(port, way))].restore();
}

LineCounters PacketRelay::counters(int port, Way way) const {
    const std::lock_guard lock(mutex_);
    return lines_[static_cast<std::size_t>(line_of(port, way))].counters();
}

std::chrono::nanoseconds PacketRelay::largest_lateness() const {
    const std::lock_guard lock(mutex_);
    return std::chrono::nanoseconds(largest_lateness_ns_);
}

void PacketRelay::forget_lateness() {
    const std::lock_guard lock(mutex_);
    largest_lateness_ns_ = 0;
}

std::chrono::nanoseconds PacketRelay::processor_time() const {
    clockid_t clock{};
    timespec time{};
    // the thread lives as long as this object
    pthread_getcpuclockid(const_cast<std::jthread&>(thread_).native_handle(), &clock);
    clock_gettime(clock, &time);
    return std::chrono::nanoseconds(time.tv_sec * kSecond_ns + time.tv_nsec);
}

void PacketRelay::run(const std::stop_token& stop) {
    pthread_setname_np(pthread_self(), "packet relay");
    std::array<epoll_event, 16> ready{};
    while (!stop.stop_requested()) {
        const int num_ready =
            epoll_wait(epoll_.get(), ready.data(), static_cast<int>(ready.size()), -1);
        const std::lock_guard lock(mutex_);
        for (int i = 0; i < num_ready; ++i) {
            const int index = ready[static_cast<std::size_t>(i)].data.fd;
            if (index < static_cast<int>(ports_.size())) read_all(index);
        }
        deliver_due();
        arm_timer();
    }
}

void PacketRelay::read_all(int port) {
    for (int i = 0; i < kReadsAtOnce; ++i) {
        const int index = new_packet();
        Packet& packet = *packets_[static_cast<std::size_t>(index)];
        const ssize_t num_bytes = read(ports_[static_cast<std::size_t>(port)].tun->get(),
                                       packet.bytes.data(),
                                       packet.bytes.size());
        if (num_bytes > 0 && is_carried(packet.bytes.data(), static_cast<std::size_t>(num_bytes))) {
            packet.num_bytes = static_cast<std::size_t>(num_bytes);
            enter(line_of(port, Way::kUp), index, now());
        }
        release(index);
        if (num_bytes <= 0) return;  // nothing available
    }
}

void PacketRelay::enter(int line, int packet, std::int64_t now_ns) {
    Packet& data = *packets_[static_cast<std::size_t>(packet)];
    const Passage passage = lines_[static_cast<std::size_t>(line)].enter(now_ns, data.num_bytes);
    if (passage.fate != Fate::kPasses) return;
    for (int i = 0; i < (passage.twice ? 2 : 1); ++i) {
        ++data.num_uses;
        events_.push_back({passage.leaves_ns, num_events_++, line, packet});
        std::push_heap(events_.begin(), events_.end(), is_later);
    }
}

void PacketRelay::deliver_due() {
    while (!events_.empty() && events_.front().due_ns <= now()) {
        std::pop_heap(events_.begin(), events_.end(), is_later);
        const Event event = events_.back();
        events_.pop_back();
        leave(event);
        release(event.packet);
    }
}

void PacketRelay::leave(const Event& event) {
    const int port = event.line / 2;
    if (event.line == line_of(port, Way::kUp)) {
        forward(port, event.packet, event.due_ns);
    } else {
        write(port, event);
    }
    const Packet& packet = *packets_[static_cast<std::size_t>(event.packet)];
    lines_[static_cast<std::size_t>(event.line)].note_left(packet.num_bytes);
}

void PacketRelay::forward(int from_port, int packet, std::int64_t now_ns) {
    const std::uint32_t to = destination(packets_[static_cast<std::size_t>(packet)]->bytes.data());
    for (std::size_t i = 0; i < ports_.size(); ++i) {
        const int port = static_cast<int>(i);
        const bool is_meant = IN_MULTICAST(to) ? port != from_port : to == ports_[i].address;
        if (is_meant) enter(line_of(port, Way::kDown), packet, now_ns);
    }
}

void PacketRelay::write(int port, const Event& event) {
    const Packet& packet = *packets_[static_cast<std::size_t>(event.packet)];
    // The kernel drops, and counts, packets that the host cannot take.
    [[maybe_unused]] const auto written = ::write(
        ports_[static_cast<std::size_t>(port)].tun->get(), packet.bytes.data(), packet.num_bytes);
    largest_lateness_ns_ = std::max(largest_lateness_ns_, now() - event.due_ns);
}

int PacketRelay::new_packet() {
    if (free_packets_.empty()) {
        free_packets_.push_back(static_cast<int>(packets_.size()));
        packets_.push_back(std::make_unique<Packet>());
    }
    const int index = free_packets_.back();
    free_packets_.pop_back();
    packets_[static_cast<std::size_t>(index)]->num_uses = 1;
    return index;
}

void PacketRelay::release(int packet) {
    if (--packets_[static_cast<std::size_t>(packet)]->num_uses == 0)
        free_packets_.push_back(packet);
}

void PacketRelay::arm_timer() {
    itimerspec spec{};  // all zero disarms the timer
    if (!events_.empty()) {
        const std::int64_t due_ns = std::max<std::int64_t>(events_.front().due_ns, 1);
        spec.it_value = {due_ns / kSecond_ns, due_ns % kSecond_ns};
    }
    // also clears an expiry that was not read
    timerfd_settime(timer_.get(), TFD_TIMER_ABSTIME, &spec, nullptr);
}

}  // namespace atrium::test
