#include "tools/site_control/remote_host.hpp"

#include "core/base/descriptor.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>

namespace atrium::site_control {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kNoProgram = 127;  // as shells say

std::string words(const std::vector<std::string>& command) {
    std::string text;
    for (const std::string& word : command) text += (text.empty() ? "" : " ") + word;
    return text;
}

}  // namespace

Expected<Answer> run_script(const std::vector<std::string>& command,
                            const std::string& script,
                            std::chrono::milliseconds patience) {
    // a host that hangs up must not end this program
    signal(SIGPIPE, SIG_IGN);
    int in[2] = {};
    int out[2] = {};
    if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0)
        return make_error(ErrorKind::kUnavailable, std::strerror(errno));
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const pid_t pid = fork();
    if (pid == 0) {
        sigset_t none;
        sigemptyset(&none);
        sigprocmask(SIG_SETMASK, &none, nullptr);
        signal(SIGPIPE, SIG_DFL);
        dup2(in[0], STDIN_FILENO);
        dup2(out[1], STDOUT_FILENO);
        dup2(out[1], STDERR_FILENO);
        execvp(arguments[0], arguments.data());
        _exit(kNoProgram);
    }
    auto script_end = std::make_unique<Descriptor>(in[1]);
    const Descriptor output_end(out[0]);
    close(in[0]);
    close(out[1]);
    if (pid < 0) return make_error(ErrorKind::kUnavailable, std::strerror(errno));
    fcntl(script_end->get(), F_SETFL, O_NONBLOCK);
    Answer answer;
    std::size_t num_sent = 0;
    bool is_late = false;
    const auto end = Clock::now() + patience;
    for (bool is_open = true; is_open;) {
        std::array<pollfd, 2> wanted{
            {{output_end.get(), POLLIN, 0}, {script_end ? script_end->get() : -1, POLLOUT, 0}}};
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
        if (left.count() <= 0) {
            is_late = true;
            kill(pid, SIGKILL);
            break;
        }
        // a negative descriptor is passed over
        if (poll(wanted.data(), wanted.size(), static_cast<int>(left.count())) <= 0) continue;
        if (wanted[1].revents != 0) {
            const ssize_t sent =
                write(script_end->get(), script.data() + num_sent, script.size() - num_sent);
            if (sent > 0) num_sent += static_cast<std::size_t>(sent);
            if (num_sent == script.size() || (sent < 0 && errno != EAGAIN)) script_end.reset();
        }
        if (wanted[0].revents == 0) continue;
        std::array<char, 4096> buffer{};
        const ssize_t got = read(output_end.get(), buffer.data(), buffer.size());
        if (got > 0) answer.output.append(buffer.data(), static_cast<std::size_t>(got));
        is_open = got > 0;
    }
    int status = 0;
    waitpid(pid, &status, 0);
    if (is_late)
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("no answer for {} s", patience.count() / 1000));
    answer.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (answer.exit_code == kNoProgram && answer.output.empty())
        return make_error(ErrorKind::kNotFound,
                          fmt::format("cannot run '{}': is it installed?", words(command)));
    return answer;
}

std::vector<std::string> shell_of(const std::string& host,
                                  const std::string& this_host,
                                  const std::vector<std::string>& ssh) {
    if (host == this_host) return {"sh", "-s"};
    std::vector<std::string> command = ssh;
    command.insert(command.end(), {host, "sh", "-s"});
    return command;
}

}  // namespace atrium::site_control
