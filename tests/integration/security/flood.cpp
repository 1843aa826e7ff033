#include "core/base/descriptor.hpp"

#include <CLI/CLI.hpp>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <thread>
#include <vector>

/// Floods the discovery ports of a domain's programs on this host, from outside of the world:
/// with garbage, or with copies of recorded datagrams. Of announcements of a participant each copy
/// is of another one (--new-prefix), who then begins a handshake. Prints "sent N" when it ends.
namespace {

volatile std::sig_atomic_t stop = 0;
constexpr std::size_t kPrefixBytes = 12;
constexpr std::size_t kPrefixAt = 8;  // in the header of RTPS
constexpr std::size_t kBatch = 32;

using Datagram = std::vector<unsigned char>;

// Datagrams, each behind its size as four bytes.
std::vector<Datagram> read_datagrams(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    std::vector<Datagram> all;
    for (std::uint32_t size = 0; stream.read(reinterpret_cast<char*>(&size), sizeof size);) {
        Datagram datagram(size);
        if (!stream.read(reinterpret_cast<char*>(datagram.data()), size)) break;
        all.push_back(std::move(datagram));
    }
    return all;
}

class Source {
public:
    Source(std::vector<Datagram> recorded, bool new_prefix)
        : recorded_(std::move(recorded)), new_prefix_(new_prefix) {}

    Datagram next() {
        if (recorded_.empty()) {
            Datagram garbage(20 + random_() % 400);
            for (auto& byte : garbage) byte = static_cast<unsigned char>(random_());
            // half of it looks like RTPS, as far as its header goes
            if (random_() % 2 == 0) std::memcpy(garbage.data(), "RTPS\x02\x01\x01\x10", 8);
            return garbage;
        }
        Datagram copy = recorded_[number_++ % recorded_.size()];
        if (!new_prefix_ || copy.size() < kPrefixAt + kPrefixBytes) return copy;
        std::array<unsigned char, kPrefixBytes> old{};
        std::copy_n(copy.begin() + kPrefixAt, kPrefixBytes, old.begin());
        std::array<unsigned char, kPrefixBytes> fresh{};
        for (auto& byte : fresh) byte = static_cast<unsigned char>(random_());
        for (auto at = copy.begin();;) {
            at = std::search(at, copy.end(), old.begin(), old.end());
            if (at == copy.end()) return copy;
            at = std::copy(fresh.begin(), fresh.end(), at);
        }
    }

private:
    std::vector<Datagram> recorded_;
    bool new_prefix_;
    std::size_t number_ = 0;
    std::mt19937 random_{4711};
};

}  // namespace

int main(int argc, char** argv) {
    unsigned domain = 0;
    int num_programs = 6;
    double rate = 100'000.0;
    std::string file;
    bool new_prefix = false;
    CLI::App cli;
    cli.add_option("--domain", domain);
    cli.add_option("--programs", num_programs, "number of discovery ports");
    cli.add_option("--rate", rate, "datagrams a second, to each port in turn");
    cli.add_option("--datagrams", file, "recorded ones; without: garbage");
    cli.add_flag("--new-prefix", new_prefix);
    CLI11_PARSE(cli, argc, argv);
    std::signal(SIGTERM, [](int) { stop = 1; });
    const std::vector<Datagram> recorded =
        file.empty() ? std::vector<Datagram>() : read_datagrams(file);
    if (!file.empty() && recorded.empty()) {
        std::fprintf(stderr, "no datagrams in %s\n", file.c_str());
        return 2;
    }
    Source source(recorded, new_prefix);
    const atrium::Descriptor out(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const auto begin = std::chrono::steady_clock::now();
    std::uint64_t num_sent = 0;
    std::uint64_t num_tried = 0;
    std::puts("floods");
    std::fflush(stdout);
    while (stop == 0) {
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
        if (static_cast<double>(num_tried) >= passed.count() * rate) {
            std::this_thread::sleep_for(std::chrono::microseconds(200));
            continue;
        }
        std::array<Datagram, kBatch> datagrams;
        std::array<iovec, kBatch> parts{};
        std::array<mmsghdr, kBatch> messages{};
        std::array<sockaddr_in, kBatch> to{};
        const std::size_t batch = rate < 10'000 ? 1 : kBatch;
        for (std::size_t i = 0; i < batch; ++i) {
            datagrams[i] = source.next();
            parts[i] = {datagrams[i].data(), datagrams[i].size()};
            to[i].sin_family = AF_INET;
            to[i].sin_addr.s_addr = htonl(INADDR_LOOPBACK);
            const auto index =
                static_cast<unsigned>((num_tried + i) % static_cast<std::uint64_t>(num_programs));
            to[i].sin_port = htons(static_cast<std::uint16_t>(7410 + 250 * domain + 2 * index));
            messages[i].msg_hdr.msg_name = &to[i];
            messages[i].msg_hdr.msg_namelen = sizeof to[i];
            messages[i].msg_hdr.msg_iov = &parts[i];
            messages[i].msg_hdr.msg_iovlen = 1;
        }
        const int sent =
            ::sendmmsg(out.get(), messages.data(), static_cast<unsigned>(batch), MSG_DONTWAIT);
        if (sent > 0) num_sent += static_cast<std::uint64_t>(sent);
        num_tried += batch;
    }
    std::printf("sent %llu\n", static_cast<unsigned long long>(num_sent));
    return 0;
}
