#pragma once

#include <string>
#include <vector>

/// Scripts for a POSIX shell on a host of a site. All files are below ~/.atrium/SITE/HOST there:
/// `files` has the site's file and its rig, `run` the logs and process ids.
namespace atrium::site_control {

/// A file to put on a host.
struct SentFile {
    std::string path;  // relative to `files`
    std::string text;
};

/// One program of a host.
struct Program {
    std::string name;                    // "camera_node"
    std::string installed;               // its name in a package: "atrium-camera"
    std::vector<std::string> arguments;  // paths of sent files as "files/PATH"
};

/// Where the files of a host are.
struct Place {
    std::string site;
    std::string host;
};

/// 'text', for a shell.
std::string quoted(const std::string& text);

/// Writes the files, starts the programs that do not run, and prints "started NAME PID", "runs NAME
/// PID" or "failed NAME: the end of its log".
std::string up_script(const Place& place,
                      const std::vector<SentFile>& files,
                      const std::vector<Program>& programs,
                      const std::string& folder_of_programs);

/// Ends the programs: SIGTERM, after five seconds SIGKILL. Prints "ended NAME", "killed NAME" or
/// "did not run NAME".
std::string down_script(const Place& place, const std::vector<Program>& programs);

/// Prints "runs NAME PID SECONDS" or "does not run NAME", and below it the last warning or error of
/// its log.
std::string status_script(const Place& place, const std::vector<Program>& programs);

/// Prints the last lines of the logs.
std::string logs_script(const Place& place, const std::vector<Program>& programs, int num_lines);

}  // namespace atrium::site_control
