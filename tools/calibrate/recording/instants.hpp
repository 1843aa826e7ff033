#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/recording/shots.hpp"

#include <map>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// Which numbers of pictures all cameras have.
struct Instants {
    std::size_t first_complete = 0;  // a number; 0 without pictures
    std::string doubt;               // empty if every number is complete
};

/// How the numbers of a recording count its instants: FIRST, FIRST + step, FIRST + 2 step, ...
struct Numbering {
    std::size_t first = 0;
    std::size_t step = 1;
};
/// The numbering of the pictures of all cameras together. Every tenth picture of a film, or names
/// in milliseconds, make steps above 1. Fewer than four numbers are no pattern.
Numbering numbering_of(const std::map<std::string, Shots>& shots);

/// "7" or "7 to 9".
std::string numbers_text(std::size_t first, std::size_t last);

/// The cameras whose pictures have no number in common with those of most cameras.
struct OtherInstants {
    std::vector<std::string> cameras;
    std::size_t first = 0;  // numbers of most cameras' pictures
    std::size_t last = 0;
};
/// Finds them if more than half of the cameras with numbered pictures have a number in common. Else
/// there are none: nobody knows which cameras are right. Videos have no numbers.
OtherInstants find_other_instants(const std::map<std::string, Shots>& frames);

/// Numbers the pictures FIRST, FIRST + 1, ... instead. Those of another numbering with the same
/// steps, such as masks, from their own first one. Without effect if the steps differ.
void count_by_one(std::map<std::string, Shots>& shots, const Numbering& numbering);

/// Compares the numbers of the pictures, by camera; videos have none. Error kConfiguration if no
/// number is common to all. `files`: the numbering of the files, if `frames` were counted by one.
Expected<Instants> compare_instants(const std::map<std::string, Shots>& frames,
                                    const Numbering& files = {});

/// A sentence on videos of different lengths, with the cameras that have fewer pictures; empty if
/// all are alike, or not all cameras have videos. `looks` are of the same cameras.
std::string doubt_of_lengths(const std::map<std::string, Shots>& frames,
                             const std::map<std::string, Look>& looks);

}  // namespace atrium::calibrate
