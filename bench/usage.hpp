#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace atrium::bench {

/// Returns the positional words of the command line. Prints `usage` and ends the program with 0 for
/// --help or -h, and with 2 if their number is not in `allowed`.
inline std::vector<std::string> words_or_usage(int argc,
                                               char** argv,
                                               const std::vector<std::size_t>& allowed,
                                               const char* usage) {
    std::vector<std::string> words(argv + 1, argv + argc);
    const auto asks = [](const std::string& word) { return word == "--help" || word == "-h"; };
    if (std::any_of(words.begin(), words.end(), asks)) {
        std::fputs(usage, stdout);
        std::exit(0);
    }
    if (std::find(allowed.begin(), allowed.end(), words.size()) == allowed.end()) {
        std::fputs(usage, stderr);
        std::exit(2);
    }
    return words;
}

}  // namespace atrium::bench
