#include "core/base/run_command.hpp"

#include "core/base/descriptor.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>

namespace atrium {
namespace {

constexpr std::chrono::seconds kLimit{10};
constexpr std::size_t kMaxOutputBytes = 1U << 20U;

// Reads until the end, the limit or too many bytes. False: the program still runs.
bool read_output(int pipe, std::string& text) {
    const auto end = std::chrono::steady_clock::now() + kLimit;
    for (;;) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
            end - std::chrono::steady_clock::now());
        if (left.count() <= 0 || text.size() >= kMaxOutputBytes) return false;
        pollfd waiting{pipe, POLLIN, 0};
        if (poll(&waiting, 1, static_cast<int>(left.count())) <= 0) continue;
        std::array<char, 16384> part;
        const ssize_t num_bytes = ::read(pipe, part.data(), part.size());
        if (num_bytes < 0 && errno == EINTR) continue;
        if (num_bytes <= 0) return true;
        text.append(part.data(), static_cast<std::size_t>(num_bytes));
    }
}

// The environment, in English, and with the folders of root's programs.
std::vector<std::string> command_environment() {
    std::vector<std::string> lines{"LC_ALL=C"};
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string line = *entry;
        if (line.rfind("PATH=", 0) == 0) {
            lines.push_back(line + ":/usr/sbin:/sbin:/usr/bin:/bin");
        } else if (line.rfind("LC_", 0) != 0 && line.rfind("LANG=", 0) != 0) {
            lines.push_back(line);
        }
    }
    return lines;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
    std::vector<char*> pointers;
    for (std::string& text : texts) pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
}

// posix_spawnp searches in the PATH of this process.
std::string found_program(const std::string& name) {
    if (name.find('/') != std::string::npos) return name;
    for (const char* folder : {"/usr/sbin/", "/sbin/", "/usr/bin/", "/bin/", "/usr/local/bin/"}) {
        if (access((folder + name).c_str(), X_OK) == 0) return folder + name;
    }
    return name;
}

// A file in memory that is read from its beginning.
Descriptor file_with(std::string_view text) {
    Descriptor file(memfd_create("input", MFD_CLOEXEC));
    if (file.get() < 0) return file;
    while (!text.empty()) {
        const ssize_t num_bytes = ::write(file.get(), text.data(), text.size());
        if (num_bytes <= 0) return Descriptor(-1);
        text.remove_prefix(static_cast<std::size_t>(num_bytes));
    }
    lseek(file.get(), 0, SEEK_SET);
    return file;
}

}  // namespace

std::optional<CommandOutput> run_command(const std::vector<std::string>& command,
                                         std::string_view input) {
    std::array<int, 2> ends{};
    const Descriptor given = file_with(input);
    if (command.empty() || given.get() < 0 || pipe2(ends.data(), O_CLOEXEC) != 0)
        return std::nullopt;
    const Descriptor out(ends[0]);
    Descriptor in(ends[1]);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, given.get(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, in.get(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, in.get(), STDERR_FILENO);
    std::vector<std::string> words = command;
    words[0] = found_program(words[0]);
    std::vector<std::string> variables = command_environment();
    pid_t child = -1;
    const int failure = posix_spawnp(&child,
                                     words[0].c_str(),
                                     &actions,
                                     nullptr,
                                     pointers_to(words).data(),
                                     pointers_to(variables).data());
    posix_spawn_file_actions_destroy(&actions);
    in = Descriptor(-1);
    if (failure != 0) return CommandOutput{kNoSuchProgram, ""};
    CommandOutput output;
    if (!read_output(out.get(), output.text)) kill(child, SIGKILL);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    output.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return output;
}

}  // namespace atrium
