#include "tests/support/own_network.hpp"

#include <arpa/inet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

namespace atrium::test_support {
namespace {

constexpr const char* kInside = "ATRIUM_TEST_OWN_NETWORK";

std::string& reason() {
    static std::string text = "run_in_own_network was not called";
    return text;
}

bool succeeds(const char* shell_command) {
    const int status = std::system(shell_command);
    return status != -1 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// Empty, or what went wrong.
std::string set_up_loopback(int num_addresses) {
    const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const auto failed = [&](const std::string& what) {
        const std::string text = what + ": " + std::strerror(errno);
        close(socket);
        return text;
    };
    ifreq request{};
    std::strcpy(request.ifr_name, "lo");
    request.ifr_flags = IFF_UP | IFF_RUNNING;
    if (ioctl(socket, SIOCSIFFLAGS, &request) != 0) return failed("bringing lo up");
    for (int i = 2; i <= num_addresses; ++i) {
        request = {};
        std::strcpy(request.ifr_name, ("lo:" + std::to_string(i)).c_str());
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK - 1 + static_cast<unsigned>(i));
        std::memcpy(&request.ifr_addr, &address, sizeof(address));
        if (ioctl(socket, SIOCSIFADDR, &request) != 0) return failed("a loopback address");
    }
    close(socket);
    return "";
}

}  // namespace

void run_in_own_network(char** argv, int num_addresses) {
    if (std::getenv(kInside) != nullptr) {
        reason() = set_up_loopback(num_addresses);
        return;
    }
    if (!succeeds("unshare -Urn true 2>/dev/null")) {
        reason() = "user and network namespaces are not permitted here (unshare -Urn)";
        return;
    }
    setenv(kInside, "1", 1);
    // a program starts anew in there: namespaces are entered by who has one thread only
    std::string command = "exec unshare -Urn -- \"$0\" \"$@\"";
    std::string shell = "/bin/sh";
    std::string option = "-c";
    std::size_t count = 0;
    while (argv[count] != nullptr) ++count;
    auto** const arguments = static_cast<char**>(std::calloc(count + 4, sizeof(char*)));
    arguments[0] = shell.data();
    arguments[1] = option.data();
    arguments[2] = command.data();
    for (std::size_t i = 0; i < count; ++i) arguments[3 + i] = argv[i];
    execv(shell.c_str(), arguments);
    reason() = std::string("starting again: ") + std::strerror(errno);
    std::free(arguments);
}

const std::string& reason_without_own_network() { return reason(); }

}  // namespace atrium::test_support
