#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "tools/visual_hull/tool.hpp"

#include <cstdio>

int main(int argc, char** argv) {
    using namespace atrium;
    hull_tool::ToolOptions options;
    const hull_tool::Start start = hull_tool::parse_command_line(argc, argv, options);
    if (!start.go_on) return start.exit_code;
    app::log::set_program("visual_hull");
    app::log::set_level(app::log::Level::kWarn);
    const Expected<std::string> report = hull_tool::run(options, [](const std::string& text) {
        std::fprintf(stderr, "visual_hull: warning: %s\n", text.c_str());
    });
    if (!report) {
        std::fprintf(stderr, "visual_hull: error: %s\n", report.error().message.c_str());
        return app::exit_code(report.error());
    }
    std::puts(report->c_str());
    return 0;
}
