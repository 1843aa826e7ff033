#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "tools/atrium/commands.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

int main(int argc, char** argv) {
    using namespace atrium;
    const std::vector<std::string> words(argv + 1, argv + argc);
    const auto folder = app::program_folder();
    const bool is_alone = words.size() == 1;
    if (words.empty() ||
        (is_alone && (words[0] == "help" || words[0] == "--help" || words[0] == "-h"))) {
        std::fputs(front::help(front::installed_commands(folder)).c_str(), stdout);
        return 0;
    }
    if (is_alone && words[0] == "--version") {
        std::printf("atrium %s\n", app::version().c_str());
        return 0;
    }
    auto program = front::program_for(words, folder);
    if (!program) {
        std::fprintf(stderr, "atrium: error: %s\n", program.error().message.c_str());
        return app::exit_code(program.error());
    }
    std::vector<char*> arguments;
    for (std::string& argument : *program) arguments.push_back(argument.data());
    arguments.push_back(nullptr);
    execv(arguments[0], arguments.data());
    std::fprintf(stderr, "atrium: error: %s: %s\n", arguments[0], std::strerror(errno));
    return app::exit_code({ErrorKind::kInternal, ""});
}
