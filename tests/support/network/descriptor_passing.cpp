#include "tests/support/network/descriptor_passing.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>

namespace atrium::test {
namespace {

constexpr std::size_t kMaxDescriptors = 8;
constexpr std::size_t kMaxText = 2000;

struct Letter {
    std::array<char, kMaxText> text{};  // of the error; empty without one
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int) * kMaxDescriptors)> control{};
    iovec part{text.data(), text.size()};

    msghdr header() {
        msghdr result{};
        result.msg_iov = &part;
        result.msg_iovlen = 1;
        result.msg_control = control.data();
        result.msg_controllen = control.size();
        return result;
    }
};

void post(int socket, const Expected<PassedDescriptors>& made) {
    Letter letter;
    msghdr message = letter.header();
    message.msg_control = nullptr;
    message.msg_controllen = 0;
    if (!made) {
        const std::string& text = made.error().message;
        std::copy_n(text.data(), std::min(text.size(), kMaxText - 1), letter.text.data());
    } else if (!made->empty()) {
        const std::size_t n = std::min(made->size(), kMaxDescriptors);
        message.msg_control = letter.control.data();
        message.msg_controllen = CMSG_SPACE(sizeof(int) * n);
        cmsghdr* control = CMSG_FIRSTHDR(&message);
        control->cmsg_level = SOL_SOCKET;
        control->cmsg_type = SCM_RIGHTS;
        control->cmsg_len = CMSG_LEN(sizeof(int) * n);
        for (std::size_t i = 0; i < n; ++i) {
            const int descriptor = (*made)[i]->get();
            std::memcpy(CMSG_DATA(control) + i * sizeof(int), &descriptor, sizeof(int));
        }
    }
    if (sendmsg(socket, &message, 0) < 0) _exit(1);
}

Expected<PassedDescriptors> receive(int socket) {
    Letter letter;
    msghdr message = letter.header();
    const ssize_t num_bytes = recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
    if (num_bytes <= 0)
        return make_error(ErrorKind::kInternal, "a child process ended without an answer");
    if (letter.text[0] != 0) return make_error(ErrorKind::kUnavailable, letter.text.data());
    PassedDescriptors result;
    const cmsghdr* control = CMSG_FIRSTHDR(&message);
    if (control == nullptr || control->cmsg_type != SCM_RIGHTS) return result;
    const std::size_t n = (control->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t i = 0; i < n; ++i) {
        int descriptor = -1;
        std::memcpy(&descriptor, CMSG_DATA(control) + i * sizeof(int), sizeof(int));
        result.push_back(std::make_unique<Descriptor>(descriptor));
    }
    return result;
}

}  // namespace

Expected<PassedDescriptors> descriptors_made_in_child(
    const std::function<Expected<PassedDescriptors>()>& make) {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
        return make_error(ErrorKind::kInternal,
                          fmt::format("a socket pair: {}", std::strerror(errno)));
    const Descriptor ours(ends[0]);
    const pid_t child = fork();
    if (child == 0) {
        post(ends[1], make());
        _exit(0);
    }
    close(ends[1]);  // otherwise the child would not hold the last copy of its end
    if (child < 0)
        return make_error(ErrorKind::kInternal, fmt::format("fork: {}", std::strerror(errno)));
    auto result = receive(ours.get());
    waitpid(child, nullptr, 0);
    return result;
}

}  // namespace atrium::test
