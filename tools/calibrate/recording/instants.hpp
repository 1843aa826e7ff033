#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/recording/shots.hpp"

#include <map>
#include <string>

namespace atrium::calibrate {

/// Which numbers of pictures all cameras have.
struct Instants {
    std::size_t first_complete = 0;  // a number; 0 without pictures
    std::string doubt;               // empty if every number is complete
};

/// Compares the numbers of the pictures, by camera; videos have none. Error kConfiguration if no
/// number is common to all.
Expected<Instants> compare_instants(const std::map<std::string, Shots>& frames);

}  // namespace atrium::calibrate
