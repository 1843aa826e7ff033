#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace atrium::bench {

/// The words of the command line, of a program that takes them by their places. Ends the program
/// after `usage`: with 0 where --help or -h is among them, with 2 where their number is none of
/// `allowed`.
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
