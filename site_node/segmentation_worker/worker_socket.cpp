#include "site_node/segmentation_worker/worker_socket.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

namespace atrium::segmentation_worker {
namespace {

tl::unexpected<Error> gone(const char* what) {
    return make_error(ErrorKind::kUnavailable, fmt::format("{}: {}", what, std::strerror(errno)));
}

// `descriptor`: passed along; negative: none.
Expected<void> send_bytes(int socket, const SiteMessage& message, int descriptor) {
    auto bytes = encode(message);
    iovec part{bytes.data(), bytes.size()};
    msghdr packet{};
    packet.msg_iov = &part;
    packet.msg_iovlen = 1;
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
    if (descriptor >= 0) {
        packet.msg_control = control.data();
        packet.msg_controllen = control.size();
        cmsghdr* const passed = CMSG_FIRSTHDR(&packet);
        passed->cmsg_level = SOL_SOCKET;
        passed->cmsg_type = SCM_RIGHTS;
        passed->cmsg_len = CMSG_LEN(sizeof descriptor);
        std::memcpy(CMSG_DATA(passed), &descriptor, sizeof descriptor);
    }
    if (sendmsg(socket, &packet, MSG_NOSIGNAL | MSG_DONTWAIT) < 0)
        return gone("it takes no messages");
    return {};
}

}  // namespace

Expected<WorkerSocket> WorkerSocket::connect(const std::filesystem::path& path, int shared_memory) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string& name = path.native();
    static_assert(kMaxPathBytes + 1 == sizeof address.sun_path);
    if (name.empty() || name.size() > kMaxPathBytes)
        return make_error(ErrorKind::kUnavailable, "the path of its socket is too long");
    std::copy(name.begin(), name.end(), address.sun_path);
    Descriptor socket(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (socket.get() < 0) return gone("no socket");
    if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) < 0)
        return gone("no worker at its socket");
    if (auto sent = send_bytes(socket.get(), {}, shared_memory); !sent)
        return tl::unexpected(sent.error());
    return WorkerSocket(std::move(socket));
}

Expected<void> WorkerSocket::send(const SiteMessage& message) {
    return send_bytes(socket_.get(), message, -1);
}

Expected<std::optional<WorkerMessage>> WorkerSocket::receive() {
    // longer messages are cut, but their size is told
    std::array<std::uint8_t, 2 * kWorkerMessageBytes> bytes{};
    const auto num = recv(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (num < 0 && (errno == EAGAIN || errno == EINTR)) return std::nullopt;
    if (num < 0) return gone("its connection broke");
    if (num == 0) return make_error(ErrorKind::kUnavailable, "it closed its connection");
    const auto message = decode(std::span(bytes).first(static_cast<std::size_t>(num)));
    if (!message) return tl::unexpected(message.error());
    return *message;
}

void WorkerSocket::wait(std::chrono::nanoseconds limit) const {
    pollfd look{socket_.get(), POLLIN, 0};
    const auto left = std::max(limit, std::chrono::nanoseconds(0));
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
    const timespec time{seconds.count(), (left - seconds).count()};
    ppoll(&look, 1, &time, nullptr);  // an interrupted wait is a short one
}

}  // namespace atrium::segmentation_worker
