#include "tests/unit/segmentation_worker/fake_worker.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace atrium::test {
namespace {

constexpr std::size_t kSiteBytes = 32;
constexpr std::size_t kWorkerBytes = 24;

template <typename Number>
Number at(const std::uint8_t* bytes) {
    Number value;
    std::memcpy(&value, bytes, sizeof value);  // tests run on little-endian machines
    return value;
}

}  // namespace

FakeConnection::FakeConnection(Descriptor socket) : socket_(std::move(socket)), memory_(-1) {
    std::array<std::uint8_t, kSiteBytes> hello{};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
    iovec part{hello.data(), hello.size()};
    msghdr packet{};
    packet.msg_iov = &part;
    packet.msg_iovlen = 1;
    packet.msg_control = control.data();
    packet.msg_controllen = control.size();
    EXPECT_EQ(recvmsg(socket_.get(), &packet, 0), static_cast<ssize_t>(kSiteBytes));
    EXPECT_EQ(at<std::uint32_t>(hello.data()), 1u);
    EXPECT_EQ(at<std::uint32_t>(hello.data() + 4), 1u);
    const cmsghdr* const passed = CMSG_FIRSTHDR(&packet);
    if (passed == nullptr) {
        ADD_FAILURE() << "no memory was passed";
        return;
    }
    int descriptor = -1;
    std::memcpy(&descriptor, CMSG_DATA(passed), sizeof descriptor);
    memory_ = Descriptor(descriptor);
    struct stat status {};
    EXPECT_EQ(fstat(descriptor, &status), 0);
    num_bytes_ = static_cast<std::size_t>(status.st_size);
    void* const bytes =
        mmap(nullptr, num_bytes_, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    EXPECT_NE(bytes, MAP_FAILED);
    bytes_ = static_cast<std::uint8_t*>(bytes);
}

FakeConnection::~FakeConnection() {
    if (bytes_ != nullptr) munmap(bytes_, num_bytes_);
}

std::uint32_t FakeConnection::number32(std::size_t offset) const {
    return at<std::uint32_t>(bytes_ + offset);
}

std::uint64_t FakeConnection::number64(std::size_t offset) const {
    return at<std::uint64_t>(bytes_ + offset);
}

std::string FakeConnection::text(std::size_t offset) const {
    return reinterpret_cast<const char*>(bytes_ + offset);
}

std::span<std::uint8_t> FakeConnection::plane(std::size_t offset,
                                              std::size_t bytes_per_pixel) const {
    return {bytes_ + number64(offset), bytes_per_pixel * width() * height()};
}

std::optional<FakeConnection::Picture> FakeConnection::receive() const {
    std::array<std::uint8_t, 2 * kSiteBytes> bytes{};
    const ssize_t num = recv(socket_.get(), bytes.data(), bytes.size(), 0);
    if (num <= 0) return std::nullopt;
    EXPECT_EQ(num, static_cast<ssize_t>(kSiteBytes));
    return Picture{at<std::uint32_t>(bytes.data()),
                   at<std::uint32_t>(bytes.data() + 4),
                   at<std::uint64_t>(bytes.data() + 8),
                   at<std::int64_t>(bytes.data() + 16),
                   at<std::uint32_t>(bytes.data() + 24)};
}

void FakeConnection::answer(std::uint64_t number, std::uint8_t alpha) const {
    std::ranges::fill(plane(56, 1), alpha);
    send(message(2, number));
}

std::vector<std::uint8_t> FakeConnection::message(std::uint32_t kind, std::uint64_t number) const {
    std::vector<std::uint8_t> bytes(kWorkerBytes);
    const std::uint32_t version = 1;
    const std::array<std::uint32_t, 2> size{width(), height()};
    std::memcpy(bytes.data(), &kind, sizeof kind);
    std::memcpy(bytes.data() + 4, &version, sizeof version);
    std::memcpy(bytes.data() + 8, &number, sizeof number);
    std::memcpy(bytes.data() + 16, size.data(), sizeof size);
    return bytes;
}

void FakeConnection::send(const std::vector<std::uint8_t>& bytes) const {
    // the site may have cut the connection
    (void)::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

FakeWorker::FakeWorker(const std::filesystem::path& path)
    : path_(path), listener_(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::ranges::copy(path.native(), address.sun_path);
    EXPECT_EQ(bind(listener_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0)
        << path;
    EXPECT_EQ(listen(listener_.get(), 16), 0);
}

FakeWorker::~FakeWorker() { unlink(path_.c_str()); }

std::unique_ptr<FakeConnection> FakeWorker::accept() const {
    return std::make_unique<FakeConnection>(
        Descriptor(::accept(listener_.get(), nullptr, nullptr)));
}

bool FakeWorker::has_visitor() const {
    pollfd look{listener_.get(), POLLIN, 0};
    return poll(&look, 1, 0) == 1;
}

}  // namespace atrium::test
