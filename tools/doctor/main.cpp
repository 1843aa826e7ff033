#include "core/app/program.hpp"
#include "tools/doctor/doctor.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string_view>

namespace {

constexpr int kExitIll = 1;

atrium::doctor::TextStyle style_of_output(bool is_verbose) {
    atrium::doctor::TextStyle style;
    style.shows_checked = is_verbose;
    style.says_healthy = is_verbose;
    if (isatty(STDOUT_FILENO) == 0) return style;
    winsize size{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1) style.width = size.ws_col;
    // https://no-color.org: any value of NO_COLOR except an empty one disables colours
    const char* forbidden = std::getenv("NO_COLOR");
    const char* terminal = std::getenv("TERM");
    style.has_colour = (forbidden == nullptr || *forbidden == '\0') && terminal != nullptr &&
                       std::string_view(terminal) != "dumb";
    style.says_healthy = true;
    return style;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace atrium;
    doctor::Options options;
    const doctor::Start start = doctor::parse_command_line(argc, argv, options);
    if (!start.go_on) return start.exit_code;
    std::unique_ptr<doctor::System> system;
    if (options.root.empty()) {
        system = std::make_unique<doctor::LiveSystem>();
    } else {
        system = std::make_unique<doctor::System>(options.root);
    }
    const auto report = doctor::examine(options, *system, style_of_output(options.is_verbose));
    if (!report) {
        std::fprintf(stderr, "doctor: error: %s\n", report.error().message.c_str());
        return app::exit_code(report.error());
    }
    std::fputs(report->text.c_str(), stdout);
    return report->is_ill ? kExitIll : 0;
}
