#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/recording/shots.hpp"
#include "tools/calibrate/recording/time_grid.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// Which numbers of pictures all cameras have.
struct Instants {
    std::size_t first_complete = 0;  // a number; 0 without pictures
    std::string doubt;               // empty if every number is complete
};

/// How the numbers of a recording count its instants: FIRST, FIRST + step, FIRST + 2 step, ...; or
/// they are times.
struct Numbering {
    std::size_t first = 0;
    std::size_t step = 1;

    /// Of times.
    struct Times {
        std::string unit;
        bool is_guessed = false;                   // plain numbers that look like times
        std::uint64_t nanoseconds = 1;             // of one unit of the numbers
        TimeGrid grid;                             // times in nanoseconds
        std::map<std::size_t, std::string> names;  // of a picture of each instant
        double rate_hz() const { return 1e9 / grid.period_ns; }
    };
    std::optional<Times> times = {};

    /// "7" or "7 to 9": instants FIRST and LAST, counted by one, as the files are named.
    std::string text(std::size_t from, std::size_t to) const;
};
/// The numbering of the pictures of all cameras together. Times are those that all cameras with
/// pictures have in their names, or numbers with about equal steps that look like times. Every
/// tenth picture of a film makes steps above 1. Fewer than four numbers are no pattern.
Numbering numbering_of(const std::map<std::string, Shots>& shots);

/// Names the cause and cure if less than half of the numbers, counted by one, have pictures.
std::string doubt_of_sparse_numbers(const std::map<std::string, Shots>& shots,
                                    const Numbering& files);

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
/// steps, such as masks, from their own first one. Without effect if the steps differ, or if most
/// pictures have other times.
void count_by_one(std::map<std::string, Shots>& shots, const Numbering& numbering);

/// Compares the numbers of the pictures, by camera; videos have none. Error kConfiguration if no
/// number is common to all. `files`: the numbering of the files, if `frames` were counted by one.
Expected<Instants> compare_instants(const std::map<std::string, Shots>& frames,
                                    const Numbering& files = {});

/// A sentence on videos of different lengths, with the cameras that have fewer pictures; empty if
/// all are alike, or not all cameras have videos. `looks` are of the same cameras.
std::string doubt_of_lengths(const std::map<std::string, Shots>& frames,
                             const std::map<std::string, Look>& looks);

/// A sentence on a list of the pictures' times, a CSV file with "time" in its name, that lies
/// beside videos: it is not read. Empty without one, or not all cameras have videos.
std::string doubt_of_listed_times(const std::map<std::string, Shots>& frames);

}  // namespace atrium::calibrate
