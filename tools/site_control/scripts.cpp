#include "tools/site_control/scripts.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace atrium::site_control {
namespace {

// Hosts may share their home folder.
std::string beginning(const Place& place) {
    return fmt::format(
        "set -u\nbase=\"$HOME/.atrium\"/{}/{}\nmkdir -p \"$base/run\" \"$base/files\" "
        "&& cd \"$base\" || exit 1\n"
        // Whether the process that we started still runs: its number alone may be that of another
        // one by now. No zombies.
        "since() {{ sed -n 's/.*) \\([^Z] .*\\)/\\1/p' \"/proc/$1/stat\" 2>/dev/null | "
        "cut -d ' ' -f 20; }}\n"
        "runs() {{ read -r pid began 2>/dev/null < \"run/$1.pid\" && [ -n \"$began\" ] && "
        "[ \"$(since \"$pid\")\" = \"$began\" ]; }}\n",
        quoted(place.site),
        quoted(place.host));
}

// A text that no file of a site contains as a line.
constexpr const char* kEndOfFile = "ATRIUM-END-OF-FILE-3f9c";

}  // namespace

std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'')
            out += "'\\''";
        else
            out += c;
    }
    return out + "'";
}

std::string up_script(const Place& place,
                      const std::vector<SentFile>& files,
                      const std::vector<Program>& programs,
                      const std::string& folder_of_programs) {
    std::string script = beginning(place);
    for (const SentFile& file : files) {
        const std::string folder = std::filesystem::path(file.path).parent_path().string();
        // a program must not start with the file of before
        script += fmt::format("mkdir -p files/{} || exit 1\n", quoted(folder));
        script += fmt::format("cat > files/{} << '{}' || exit 1\n{}{}{}\n",
                              quoted(file.path),
                              kEndOfFile,
                              file.text,
                              file.text.ends_with('\n') ? "" : "\n",
                              kEndOfFile);
    }
    for (const Program& program : programs) {
        std::string arguments;
        for (const std::string& argument : program.arguments) arguments += " " + quoted(argument);
        script += fmt::format(
            "if runs {0}; then echo \"runs {0} $pid\"; else\n"
            "  program={1}/{0}\n"
            "  [ -x \"$program\" ] || program=$(command -v {2} || command -v {0} || true)\n"
            "  if [ -z \"$program\" ]; then echo \"failed {0}: it is not installed on this host\"; "
            "else\n"
            "    setsid nohup \"$program\"{3} > run/{0}.log 2>&1 < /dev/null &\n"
            "    echo \"$! $(since $!)\" > run/{0}.pid\n"
            "    sleep 1\n"
            "    if runs {0}; then echo \"started {0} $pid\"; else\n"
            "      echo \"failed {0}: $(tail -n 1 run/{0}.log)\"; rm -f run/{0}.pid; fi\n"
            "  fi\nfi\n",
            program.name,
            quoted(folder_of_programs),
            program.installed,
            arguments);
    }
    return script;
}

std::string down_script(const Place& place, const std::vector<Program>& programs) {
    std::string script = beginning(place);
    for (const Program& program : programs) {
        script += fmt::format(
            "if runs {0}; then\n"
            "  kill -TERM \"$pid\"\n"
            "  for i in 1 2 3 4 5 6 7 8 9 10; do runs {0} || break; sleep 0.5; done\n"
            "  if runs {0}; then kill -KILL \"$pid\"; echo \"killed {0}\"; else echo \"ended "
            "{0}\"; fi\n"
            "else echo \"did not run {0}\"; fi\nrm -f run/{0}.pid\n",
            program.name);
    }
    return script;
}

std::string status_script(const Place& place, const std::vector<Program>& programs) {
    std::string script = beginning(place);
    for (const Program& program : programs) {
        script += fmt::format(
            // without `ps`: a bare Debian has none
            "if runs {0}; then\n"
            "  seconds=$(($(cut -d . -f 1 /proc/uptime) - began / $(getconf CLK_TCK)))\n"
            "  echo \"runs {0} $pid, for $seconds s\"\n"
            "  grep -E ' (warning|error) ' run/{0}.log 2>/dev/null | tail -n 1 | sed 's/^/  /'\n"
            "else\n"
            "  echo \"does not run {0}\"\n"
            // why it ended, not what was wrong long before somebody ended it
            "  tail -n 1 run/{0}.log 2>/dev/null | grep -E ' error[: ]' | sed 's/^/  /'\n"
            "fi\n",
            program.name);
    }
    return script + "exit 0\n";
}

std::string logs_script(const Place& place, const std::vector<Program>& programs, int num_lines) {
    std::string script = beginning(place);
    for (const Program& program : programs)
        script += fmt::format("tail -n {} run/{}.log 2>/dev/null || echo \"{} has no log here\"\n",
                              num_lines,
                              program.name,
                              program.name);
    return script;
}

}  // namespace atrium::site_control
